// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/reproduction/markdown.hpp>
#include <palpate/reproduction/page.hpp>
#include <palpate/reproduction/paper_catheter.hpp>
#include <palpate/reproduction/parts.hpp>
#include <set>
#include <stdexcept>

namespace palpate::reproduction {
namespace {

using testing::HasSubstr;

TEST(PaperCatheter, ShippedFileSaysTheSame) {
  const CatheterFile file = read_catheter_file(PALPATE_SOURCE_DIR "/examples/paper_catheter.toml");
  const Catheter ours = paper_catheter();
  ASSERT_EQ(file.catheter.rod.sections.size(), 1U);
  const Section &read = file.catheter.rod.sections[0], &coded = ours.rod.sections[0];
  EXPECT_NEAR(read.to_m, coded.to_m, 1e-15);
  EXPECT_LT((read.stiffness_Nm2 - coded.stiffness_Nm2).norm(), 1e-15);
  EXPECT_EQ(read.precurvature_per_m, coded.precurvature_per_m);
  ASSERT_EQ(file.catheter.sensors.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(file.catheter.sensors[i].name, ours.sensors[i].name);
    EXPECT_NEAR(file.catheter.sensors[i].arc_length_m, ours.sensors[i].arc_length_m, 1e-12);
    EXPECT_NEAR(file.catheter.sensors[i].noise_m.x(), ours.sensors[i].noise_m.x(), 1e-12);
  }
  EXPECT_TRUE(file.warnings.empty());
}

/// Every part whose making takes no more than a second; the others run as a whole in the application's test.
class EveryPart : public testing::TestWithParam<const PartMaker*> {};

TEST_P(EveryPart, HasATitleAndRefersToItsPictures) {
  const Part part = GetParam()->make({.workers = 1});
  EXPECT_FALSE(part.title.empty());
  EXPECT_GT(part.markdown.size(), 100U);
  EXPECT_THAT(part.markdown, testing::Not(HasSubstr("nan")));
  for (const NamedFigure& f : part.figures) {
    EXPECT_THAT(part.markdown, HasSubstr("(" + f.name + ".svg)"));
    for (const plot::Panel& panel : f.figure.panels) {
      EXPECT_FALSE(panel.x_label.empty() || panel.y_label.empty());
      for (const plot::Series& s : panel.series) EXPECT_EQ(s.x.size(), s.y.size()) << f.name << " " << s.label;
    }
  }
}

std::vector<const PartMaker*> ours() {
  std::vector<const PartMaker*> found;
  for (const char* name : {"table2", "figure3", "table3", "figure4", "figure5", "figure6", "table4", "table5",
                           "figure7", "window", "eq8", "euler", "curvature_channel", "scale"})
    for (const PartMaker* maker : parts_named(name)) found.push_back(maker);
  return found;
}

INSTANTIATE_TEST_SUITE_P(Reproduction, EveryPart, testing::ValuesIn(ours()),
                         [](const auto& part) { return std::string(part.param->name); });

TEST(Parts, NamesAreUniqueAndGroupsHoldThem) {
  std::set<std::string_view> names;
  for (const PartMaker& maker : all_parts()) EXPECT_TRUE(names.insert(maker.name).second) << maker.name;
  EXPECT_EQ(parts_named("all").size(), all_parts().size());
  EXPECT_EQ(parts_named("corrections").size(), 5U);
  EXPECT_TRUE(parts_named("table9").empty());
}

TEST(Corrections, ScaleIsTheDirectionThatNothingTells) {
  EXPECT_THAT(make_scale({}).markdown, HasSubstr("cosine between the two is 1.000000000"));
}

Part echo(const Settings& settings) {
  if (settings.progress) settings.progress(0.5);
  return {.title = "t", .markdown = "m\n"};
}
Part fail(const Settings&) { throw std::runtime_error("no"); }

TEST(MakeParts, KeepsTheOrderReportsProgressAndPassesFailuresOn) {
  const PartMaker good{"good", "", echo}, bad{"bad", "", fail};
  double last = 0.0;
  const std::vector<const PartMaker*> two{&good, &good};
  EXPECT_EQ(make_parts(two, 2, [&](double share) { last = share; }).size(), 2U);
  EXPECT_EQ(last, 1.0);
  const std::vector<const PartMaker*> broken{&good, &bad, &good};
  EXPECT_THROW(make_parts(broken, 2), std::runtime_error);
}

TEST(Markdown, TablesAlign) {
  const MarkdownTable table{{"a", "bcde"}, {{"12345", "x"}}};
  EXPECT_EQ(table.text(), "| a     | bcde |\n|-------|------|\n| 12345 | x    |\n");
  EXPECT_EQ(short_number(3.237e-5), "3.24e-05");
  EXPECT_EQ(against(2.0, -1.0), "2 times");
  EXPECT_EQ(against(-1.0, 1.0), "below");
}

}  // namespace
}  // namespace palpate::reproduction
