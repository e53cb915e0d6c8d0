// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/toml_edit.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

using ::testing::HasSubstr;

/// The oracle is the text itself, written out as it should be.
class TomlEdits : public test::TemporaryFolder {
 protected:
  TomlEdit edit(const std::string& text) const { return TomlEdit(write("c.toml", text)); }
};

TEST_F(TomlEdits, OnlyTheValueChanges) {
  TomlEdit e =
      edit("# Mü's catheter\n\n[catheter] # shaft\nname = \"ü\"\nlength_mm=70.0# long\nx = [1,\n  2]  # two\n");
  e.set("catheter", "length_mm", "71.5");
  EXPECT_EQ(e.text(),
            "# Mü's catheter\n\n[catheter] # shaft\nname = \"ü\"\nlength_mm=71.5# long\nx = [1,\n  2]  # two\n");
  e.set("catheter", "x", "[3, 4]", "measured");
  e.set("catheter", "name", "\"ö\"");
  EXPECT_EQ(e.text(),
            "# Mü's catheter\n\n[catheter] # shaft\nname = \"ö\"\nlength_mm=71.5# long\nx = [3, 4]  # measured\n");
}

TEST_F(TomlEdits, AbsentKeysAndTablesAreAdded) {
  TomlEdit e = edit("[a]\nb = 1 # one\n[c]\n");
  e.set("a", "d", "2", "new");
  e.set("e", "f", "3");
  e.set("e", "g", "4");
  EXPECT_EQ(e.text(), "[a]\nd = 2  # new\nb = 1 # one\n[c]\n\n[e]\ng = 4\nf = 3\n");
}

TEST_F(TomlEdits, TablesOfAnArrayByTheirPlace) {
  TomlEdit e = edit("[[s]]\nn = 1\n[[s]]\nn = 2\n");
  e.set("s", 1, "n", "3");
  e.set("s", 0, "m", "4");
  EXPECT_EQ(e.text(), "[[s]]\nm = 4\nn = 1\n[[s]]\nn = 3\n");
  EXPECT_THROW(e.set("s", 2, "n", "5"), InputError);
}

TEST_F(TomlEdits, AsksTablesOfAnArray) {
  TomlEdit e = edit("[a]\nb = 1\n[[s]]\nname = \"x\"\nn = 1\n[[s]]\nname = \"y\"\n");
  EXPECT_EQ(e.names("s"), (std::vector<std::string>{"x", "y"}));
  EXPECT_TRUE(e.names("a").empty() && e.names("no").empty());
  EXPECT_TRUE(e.has("s", 0, "n") && e.has("a", 0, "b"));
  EXPECT_FALSE(e.has("s", 1, "n") || e.has("s", 2, "n") || e.has("no", 0, "n"));
  e.remove("s", 1, "n");  // absent
  e.remove("s", 0, "n");
  EXPECT_EQ(e.text(), "[a]\nb = 1\n[[s]]\nname = \"x\"\n[[s]]\nname = \"y\"\n");
}

TEST_F(TomlEdits, RemovesAndHeads) {
  TomlEdit e = edit("[a]\nb = [\n1]\nc = 2\n");
  e.remove("a", "b");
  e.remove("a", "absent");
  e.remove("no", "b");
  e.add_heading("found so");
  EXPECT_EQ(e.text(), "# found so\n[a]\nc = 2\n");
}

TEST_F(TomlEdits, InlineTablesAndDottedKeys) {
  TomlEdit e = edit("a = {b = 1, c = 2}\nd.e = 3\n");
  e.set("a", "b", "9", "nine");  // no room for a comment
  e.set("d", "e", "4");
  EXPECT_EQ(e.text(), "a = {b = 9, c = 2}\nd.e = 4\n");
  EXPECT_THAT(error_of([&] { e.set("d", "f", "5"); }), HasSubstr("c.toml:2: expected the table d under a header [d]"));
}

TEST_F(TomlEdits, Numbers) {
  EXPECT_EQ(toml_number(0.2612e-3), "0.0002612");
  EXPECT_EQ(toml_number(3.0), "3.0");
  EXPECT_EQ(toml_number(1.0 / 3.0, 3), "0.333");
  EXPECT_EQ(toml_number(1e-7), "1e-07");
  EXPECT_EQ(toml_array({1.0, 0.5}), "[1.0, 0.5]");
}

TEST_F(TomlEdits, AWrittenCatheterFileIsOneThatCanBeRead) {
  TomlEdit e = edit(
      "[catheter]\nlength_mm = 70.0\nbending_stiffness_Nm2 = [2e-4, 2e-4]\ntorsional_stiffness_Nm2 = "
      "1e-4\n[base]\nquaternion_wxyz = [1, 0, 0, 0]\nposition_mm = [0, 0, 0]\n"
      "[[sensor]]\nname = \"tip\"\narc_length_mm = 70.0\n");
  e.set("catheter", "bending_stiffness_Nm2", toml_array({3e-4, 1e-4}), "identified");
  const std::filesystem::path out = write("new.toml", "old");
  write_catheter_file(e, out);
  EXPECT_EQ(read_catheter_file(out).catheter.rod.sections[0].stiffness_Nm2, Stiffness(3e-4, 1e-4, 1e-4));
  e.set("catheter", "length_mm", "-1");
  EXPECT_THAT(error_of([&] { write_catheter_file(e, out); }), HasSubstr("new.toml:2: catheter.length_mm = -1"));
  EXPECT_EQ(read_catheter_file(out).catheter.rod.length_m(), 0.07);
}

}  // namespace
}  // namespace palpate
