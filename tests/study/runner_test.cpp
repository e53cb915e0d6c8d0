// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <deque>
#include <palpate/math/errors.hpp>
#include <palpate/study/runner.hpp>
#include <tests/recording/temporary_folder.hpp>

/// What a campaign makes of workers that end.
namespace palpate::study {
namespace {

using ::testing::HasSubstr;

/// One worker: `lost` says of each shard given whether it is lost.
class FakeWorkers final : public Workers {
 public:
  explicit FakeWorkers(const std::function<bool(std::uint64_t)>& lost) : lost_(lost) {}
  int count() const override { return 1; }
  void give(int /*worker*/, std::uint64_t shard) override { given_.push_back(shard); }
  WorkerEvent wait() override {
    WorkerEvent event{.kind = WorkerEvent::Kind::kResult, .result = {}, .shard = given_.front(), .reason = "no reason"};
    given_.pop_front();
    if (lost_(event.shard)) event.kind = WorkerEvent::Kind::kLost;
    event.result = {.shard = event.shard, .rows = {{.run = event.shard, .values = {1.0, 2.0, 3.0}, .failure = {}}}};
    return event;
  }

 private:
  std::function<bool(std::uint64_t)> lost_;
  std::deque<std::uint64_t> given_;
};

class Runner : public test::TemporaryFolder {
 protected:
  CampaignSummary play(const std::function<bool(std::uint64_t)>& lost) const {
    Plan plan;
    plan.measures = {Measure::kRmse};
    plan.repeats = 20;
    plan.shard_runs = 1;
    Results results(
        plan, {}, [] { return std::string("f"); }, path("r.study"));
    return run_campaign(plan, results, [&] { return std::make_unique<FakeWorkers>(lost); }, {});
  }
};

TEST_F(Runner, AShardThatEndsThreeWorkersIsGivenUp) {
  const CampaignSummary summary = play([](std::uint64_t shard) { return shard % 4 == 0; });
  EXPECT_THAT(summary.given_up, ::testing::ElementsAre(0, 4, 8, 12, 16));
  EXPECT_EQ(summary.shards_played, 15U);
  EXPECT_EQ(summary.workers_lost, 15U);
  EXPECT_EQ(summary.lost.size(), 10U);
}

TEST_F(Runner, WorkersThatAllEndEndTheCampaign) {
  EXPECT_THAT(error_of([&] { play([](std::uint64_t shard) { return shard > 4; }); }),
              HasSubstr("4 workers ended one after the other, without a result between; the last: no reason"));
  EXPECT_EQ(read_head(open_results(path("r.study"))).shards_done, 5U);
}

TEST_F(Runner, NobodyIsAskedWhereNothingIsMissing) {
  play([](std::uint64_t) { return false; });
  Plan plan;
  plan.measures = {Measure::kRmse};
  plan.repeats = 20;
  plan.shard_runs = 1;
  const auto fingerprint = []() -> std::string { throw InputError("asked"); };
  Results results(plan, {}, fingerprint, path("r.study"));
  const CampaignSummary summary =
      run_campaign(plan, results, []() -> std::unique_ptr<Workers> { throw InputError("made"); }, {});
  EXPECT_TRUE(summary.complete());
  EXPECT_EQ(summary.workers, 0U);
}

/// What a file that cannot be begun leaves: nothing.
TEST_F(Runner, AFingerprintThatFailsLeavesNoFile) {
  Plan plan;
  plan.measures = {Measure::kRmse};
  plan.shard_runs = 1;
  const auto fingerprint = []() -> std::string { throw InputError("no"); };
  EXPECT_EQ(error_of([&] { Results(plan, {}, fingerprint, path("r.study")); }), "no");
  EXPECT_TRUE(std::filesystem::is_empty(path("")));
}

}  // namespace
}  // namespace palpate::study
