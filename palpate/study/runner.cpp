// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>
#include <map>
#include <palpate/math/errors.hpp>
#include <palpate/study/runner.hpp>

namespace palpate::study {

namespace {

constexpr std::uint64_t kMostAttempts = 3, kMostTold = 10;

class Campaign {
 public:
  Campaign(const Plan& plan, Results& results, const CampaignOptions& options)
      : plan_(plan), results_(results), options_(options) {
    for (std::uint64_t shard = 0; shard < plan.shards(); ++shard) {
      if (!options.part.holds(shard)) continue;
      ++summary_.shards;
      summary_.shards_before += results.done(shard) ? 1 : 0;
      progress_.runs += runs_of(shard);
      progress_.runs_done += results.done(shard) ? runs_of(shard) : 0;
    }
    runs_before_ = progress_.runs_done;
  }

  CampaignSummary run(const MakeWorkers& make_workers) {
    if (summary_.shards_before < summary_.shards && !stopped()) {
      workers_ = make_workers();
      summary_.workers = static_cast<std::uint64_t>(workers_->count());
      for (int worker = workers_->count() - 1; worker >= 0; --worker) idle_.push_back(worker);
      hand_out();
    }
    while (busy_ > 0 && !stopped()) {
      WorkerEvent event = workers_->wait();
      if (event.kind == WorkerEvent::Kind::kResult) take(event);
      if (event.kind == WorkerEvent::Kind::kLost) lose(event);
      hand_out();
      tell();
    }
    summary_.stopped = stopped();
    summary_.seconds = seconds();
    return summary_;
  }

 private:
  std::uint64_t runs_of(std::uint64_t shard) const {
    const RunRange range = shard_range(plan_, shard);
    return range.end - range.first;
  }

  bool stopped() const { return options_.stop != nullptr && *options_.stop != 0; }

  /// The next shard that is to be played; false where there is none.
  bool next(std::uint64_t& shard) {
    if (!again_.empty()) {
      shard = again_.front();
      again_.pop_front();
      return true;
    }
    while (next_ < plan_.shards() && (!options_.part.holds(next_) || results_.done(next_))) ++next_;
    if (next_ >= plan_.shards()) return false;
    shard = next_++;
    return true;
  }

  void hand_out() {
    for (std::uint64_t shard = 0; !idle_.empty() && next(shard); ++busy_) {
      workers_->give(idle_.back(), shard);
      idle_.pop_back();
    }
  }

  void take(const WorkerEvent& event) {
    results_.add(event.result);
    lost_in_a_row_ = 0;
    ++summary_.shards_played;
    summary_.runs_played += event.result.rows.size();
    summary_.runs_failed += static_cast<std::uint64_t>(std::count_if(
        event.result.rows.begin(), event.result.rows.end(), [](const RunRow& row) { return !row.failure.empty(); }));
    progress_.runs_done += event.result.rows.size();
    idle_.push_back(event.worker);
    --busy_;
  }

  void lose(const WorkerEvent& event) {
    if (++lost_in_a_row_ > kMostAttempts * summary_.workers)
      throw InputError(
          fmt::format("study: {} workers ended one after the other, without a result between; the last: {}",
                      lost_in_a_row_, event.reason));
    if (event.shard >= plan_.shards()) return;  // it had nothing to do
    if (++summary_.workers_lost <= kMostTold)
      summary_.lost.push_back(fmt::format("shard {}: its worker was lost: {}", event.shard, event.reason));
    if (++attempts_[event.shard] < kMostAttempts)
      again_.push_back(event.shard);
    else
      summary_.given_up.push_back(event.shard);
    idle_.push_back(event.worker);
    --busy_;
  }

  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

  void tell() {
    const auto played = static_cast<double>(progress_.runs_done - runs_before_);
    const auto left = static_cast<double>(progress_.runs - progress_.runs_done);
    progress_.left_s = played > 0.0 ? seconds() / played * left : std::numeric_limits<double>::quiet_NaN();
    options_.progress(progress_);
  }

  using Clock = std::chrono::steady_clock;
  const Plan& plan_;
  Results& results_;
  std::unique_ptr<Workers> workers_;
  const CampaignOptions& options_;
  CampaignSummary summary_;
  Progress progress_;
  std::uint64_t next_ = 0, runs_before_ = 0, lost_in_a_row_ = 0;
  std::deque<std::uint64_t> again_;
  std::map<std::uint64_t, std::uint64_t> attempts_;
  std::vector<int> idle_;
  int busy_ = 0;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace

CampaignSummary run_campaign(const Plan& plan, Results& results, const MakeWorkers& make_workers,
                             const CampaignOptions& options) {
  return Campaign(plan, results, options).run(make_workers);
}

}  // namespace palpate::study
