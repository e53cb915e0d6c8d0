// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <palpate/service/demo.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/page.hpp>
#include <tests/service/demo_frames.hpp>

namespace palpate::service {
namespace {

/// A page of the demonstration's catheter, told by hand what the observer says.
class ServicePage : public ::testing::Test {
 protected:
  ServicePage() {
    const Scenario scenario = [&] {
      Scenario out = demo_scenario(settings_.catheters[0].settings.catheter);
      out.duration_s = 6.0;
      return out;
    }();
    run_ = run_scenario(scenario);
    truth_ = truth_of(scenario, run_);
    const CatheterFile& file = settings_.catheters[0].settings;
    live_ = std::make_unique<LiveCatheter>(0, file.catheter, file.observer, LiveCatheter::Watch{});
    views_[0].settings = &settings_.catheters[0];
    views_[0].catheter = file.catheter;
    views_[0].live = live_.get();
    page_ = std::make_unique<Page>(settings_, views_, std::vector<const PlayedTruth*>{&truth_},
                                   [this](http::ClientId, const http::Message& message) { take(message); });
  }

  void take(const http::Message& message) {
    if (!message.binary) {
      texts_.push_back(nlohmann::json::parse(*message.bytes));
      return;
    }
    std::vector<double> numbers(message.bytes->size() / sizeof(double));
    std::memcpy(numbers.data(), message.bytes->data(), message.bytes->size());
    (numbers[0] == 1.0 ? rows_ : pasts_).push_back(std::move(numbers));
  }
  /// Frame i of the run, which comes at its own time.
  void play(std::size_t i) {
    now_ns_ = kStart_ns + nanoseconds(run_.frames[i].time_s);
    live_->take(run_.frames[i], now_ns_, record_);
    if (views_[0].take(record_)) page_->take(0, views_[0].latest, now_ns_);
  }
  double at(std::string_view name, std::size_t k = 0) const {
    std::size_t place = 2 + k;
    for (const PageField& field : kPageRow) {
      if (field.name == name) return rows_.back()[place];
      place += field.count;
    }
    throw std::runtime_error(std::string(name));
  }
  Vector3d vector_at(std::string_view name) const { return {at(name, 0), at(name, 1), at(name, 2)}; }

  static constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
  Settings settings_ = demo_settings();
  VirtualRun run_;
  PlayedTruth truth_;
  std::unique_ptr<LiveCatheter> live_;
  std::vector<CatheterView> views_{1};
  std::unique_ptr<Page> page_;
  std::int64_t now_ns_ = kStart_ns;
  session::LiveRecord record_;
  std::vector<nlohmann::json> texts_;
  std::vector<std::vector<double>> rows_, pasts_;
};

TEST_F(ServicePage, TheGreetingTellsWhatARowIs) {
  page_->opened(7, now_ns_);
  ASSERT_EQ(texts_.size(), 1U);
  const auto& hello = texts_[0];
  EXPECT_EQ(hello["type"], "hello");
  std::size_t count = 0;
  for (const auto& field : hello["row"]) count += field["count"].get<std::size_t>();
  EXPECT_EQ(count, page_row_size());
  for (const auto& name : hello["history"])
    EXPECT_TRUE(
        std::any_of(hello["row"].begin(), hello["row"].end(), [&](const auto& f) { return f["name"] == name; }));
  EXPECT_EQ(hello["catheters"][0]["name"], "demo");
  EXPECT_TRUE(hello["catheters"][0]["simulated"]);
  EXPECT_EQ(hello["catheters"][0]["wall_normal"].size(), 3U);
  EXPECT_EQ(hello["bands_g"], (nlohmann::json{5.0, 10.0, 30.0, 40.0}));
  ASSERT_EQ(pasts_.size(), 1U);
  EXPECT_EQ(pasts_[0], (std::vector<double>{2.0, 0.0, 0.0}));
}

TEST_F(ServicePage, ARowSaysWhatTheEstimateSays) {
  page_->opened(7, now_ns_);
  for (std::size_t i = 0; i < run_.frames.size(); ++i) play(i);
  const Estimate& estimate = record_.estimate;
  EXPECT_EQ(rows_.back().size(), 2 + page_row_size());
  EXPECT_EQ(at("shown"), 1.0);
  EXPECT_EQ(at("state"), 1.0);
  EXPECT_EQ(at("received_ms"), 1e-6 * static_cast<double>(now_ns_));
  EXPECT_EQ(vector_at("force_tip_N"), estimate.force_tip_N);
  EXPECT_DOUBLE_EQ(at("size_N"), estimate.force_tip_N.norm());
  EXPECT_EQ(at("axial_N"), estimate.force_tip_N.z());
  EXPECT_EQ(vector_at("truth_tip_N"), run_.truth.back().force_tip_N);
  EXPECT_LT(std::abs(at("size_N") - at("truth_size_N")), 4.0 * at("sigma_size_N"));
  // The shape ends where the tracker saw the tip, and there the wall is touched.
  const std::size_t tip = 3 * (kPagePoints - 1);
  const Vector3d end(at("shaft_mm", tip), at("shaft_mm", tip + 1), at("shaft_mm", tip + 2));
  EXPECT_LT((end - vector_at("seen_mm")).norm(), 1.5);
  EXPECT_LT((end - vector_at("contact_mm")).norm(), 1e-9);
  // The tip frame column by column: d3 goes on where the shaft ends, and turns the force into the clamp's frame.
  const Vector3d before(at("shaft_mm", tip - 3), at("shaft_mm", tip - 2), at("shaft_mm", tip - 1));
  Matrix3d R;
  for (int i = 0; i < 9; ++i) R(i % 3, i / 3) = at("R_base_tip", static_cast<std::size_t>(i));
  EXPECT_GT(R.col(2).dot((end - before).normalized()), 0.99);
  EXPECT_LT((R * estimate.force_tip_N - vector_at("force_base_N")).norm(), 0.02 * estimate.force_tip_N.norm());
  EXPECT_TRUE(std::isnan(at("seen_mm", 6))) << "there are but two sensors";
  const Vector3d normal = *truth_.wall_normal_base;
  EXPECT_LT(std::abs(normal.dot(end - vector_at("wall_mm"))), 4.0);
  EXPECT_EQ(at("contact"), 1.0);
  EXPECT_GT(at("contact_integral_Ns"), 0.0);
  EXPECT_TRUE(std::isnan(at("nis")) == (estimate.dof == 0));
}

TEST_F(ServicePage, SixtyRowsASecondAtMostAndTheLatestOne) {
  page_->opened(7, now_ns_);
  for (int i = 0; i < 1000; ++i) {
    TrackerFrame frame = run_.frames[200];
    frame.time_s = 1e-3 * i;
    now_ns_ = kStart_ns + nanoseconds(frame.time_s);
    live_->take(frame, now_ns_, record_);
    views_[0].take(record_);
    page_->take(0, views_[0].latest, now_ns_);
  }
  EXPECT_LE(rows_.size(), 60U);
  EXPECT_GE(rows_.size(), 58U);
  const double last = at("received_ms");
  page_->look(now_ns_ + 20'000'000, [] { return nlohmann::json::object(); });
  EXPECT_GT(at("received_ms"), last) << "the latest of a burst is not kept back";
}

TEST_F(ServicePage, SilenceShowsNothing) {
  page_->opened(7, now_ns_);
  for (std::size_t i = 0; i < 100; ++i) play(i);
  const std::size_t before = rows_.size();
  now_ns_ += 150'000'000;
  ASSERT_TRUE(live_->look(now_ns_, record_));
  ASSERT_TRUE(views_[0].take(record_));
  page_->take(0, views_[0].latest, now_ns_);
  ASSERT_EQ(rows_.size(), before + 1);
  EXPECT_EQ(at("shown"), 0.0);
  EXPECT_EQ(at("state"), 3.0);
  for (const char* const name : {"size_N", "axial_N", "lateral_N", "angle_rad", "force_tip_N", "force_base_N",
                                 "ellipsoid_base_N", "shaft_mm", "contact_mm"})
    EXPECT_TRUE(std::isnan(at(name))) << name;
}

TEST_F(ServicePage, WhoConnectsInSilenceHearsOfIt) {
  for (std::size_t i = 0; i < 100; ++i) play(i);
  now_ns_ += 150'000'000;
  ASSERT_TRUE(live_->look(now_ns_, record_));
  ASSERT_TRUE(views_[0].take(record_));
  page_->take(0, views_[0].latest, now_ns_);
  page_->opened(7, now_ns_);
  page_->look(now_ns_, [] { return nlohmann::json::object(); });
  ASSERT_EQ(rows_.size(), 1U);
  EXPECT_EQ(at("state"), 3.0);
}

/// An observer that is behind says so once, not with every frame.
TEST_F(ServicePage, SilenceOfEveryFrameIsNoFlood) {
  page_->opened(7, now_ns_);
  for (std::size_t i = 0; i < 200; ++i) {
    play(0);
    record_.kind = session::LiveRecord::Kind::kStale;
    record_.received_ns = ++now_ns_;
    views_[0].take(record_);
    page_->take(0, views_[0].latest, now_ns_);
  }
  EXPECT_LE(rows_.size(), 3U);
}

TEST_F(ServicePage, ThePastIsSentTwiceASecondAtMost) {
  page_->opened(7, now_ns_);
  for (int i = 0; i < 100; ++i) {
    page_->text(7, R"({"watch": 0})", now_ns_);
    page_->look(now_ns_, [] { return nlohmann::json::object(); });
    now_ns_ += 20'000'000;
  }
  EXPECT_GE(pasts_.size(), 4U);
  EXPECT_LE(pasts_.size(), 5U);
}

TEST_F(ServicePage, WhoConnectsLaterGetsThePast) {
  for (std::size_t i = 0; i < run_.frames.size(); ++i) play(i);
  EXPECT_TRUE(rows_.empty()) << "nobody looks on";
  page_->opened(1, now_ns_);
  ASSERT_EQ(pasts_.size(), 1U);
  EXPECT_NEAR(pasts_[0][2], 60.0, 1.0);  // six seconds, ten rows each
  EXPECT_EQ(pasts_[0].size(), 3 + static_cast<std::size_t>(pasts_[0][2]) * kPageHistory.size());
  page_->closed(1);
  play(run_.frames.size() - 1);
  EXPECT_TRUE(rows_.empty());
}

TEST_F(ServicePage, AnswersPingsAndNothingElseThatIsWrong) {
  page_->opened(7, now_ns_);
  texts_.clear();
  page_->text(7, R"({"ping": 12.5})", now_ns_);
  ASSERT_EQ(texts_.size(), 1U);
  EXPECT_EQ(texts_[0]["ping"], 12.5);
  pasts_.clear();
  now_ns_ += 600'000'000;
  page_->text(7, R"({"watch": 0})", now_ns_);
  EXPECT_EQ(pasts_.size(), 1U);
  for (const char* const nonsense :
       {"", "null", "[]", "{\"watch\": 1}", "{\"watch\": -1}", "{\"watch\": \"x\"}", "{\"ping\": \"x\"}", "\xff", "{"})
    page_->text(7, nonsense, now_ns_);
  page_->text(99, R"({"ping": 1})", now_ns_);  // nobody that is known
  EXPECT_EQ(texts_.size(), 1U);
  EXPECT_EQ(pasts_.size(), 1U);
}

TEST_F(ServicePage, HealthFiveTimesASecondAndWhenAStateChanges) {
  page_->opened(7, now_ns_);
  texts_.clear();
  const auto look = [&] {
    page_->look(now_ns_, [] { return nlohmann::json{{"catheters", nlohmann::json::array()}}; });
  };
  for (int i = 0; i < 50; ++i) {
    look();
    now_ns_ += 20'000'000;
  }
  EXPECT_EQ(texts_.size(), 5U);
  EXPECT_EQ(texts_[0]["type"], "status");
  play(0);
  look();
  EXPECT_EQ(texts_.size(), 6U) << "it is live now";
}

}  // namespace
}  // namespace palpate::service
