// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <functional>
#include <memory>
#include <palpate/study/results.hpp>
#include <palpate/study/workers.hpp>
#include <string>
#include <vector>

namespace palpate::study {

struct Progress {
  std::uint64_t runs = 0, runs_done = 0;  ///< of those asked for
  double left_s = 0.0;                    ///< from the pace so far; NaN: none yet
};

struct CampaignOptions {
  Part part;
  std::function<void(const Progress&)> progress = [](const Progress&) {};
  const volatile std::sig_atomic_t* stop = nullptr;  ///< set: end after what has been handed in
};

using MakeWorkers = std::function<std::unique_ptr<Workers>()>;

struct CampaignSummary {
  std::uint64_t shards = 0, shards_before = 0, shards_played = 0;  ///< asked for; done before; done now
  std::uint64_t runs_played = 0, runs_failed = 0;                  ///< now
  std::uint64_t workers = 0, workers_lost = 0;                     ///< 0 workers: nothing was missing
  std::vector<std::string> lost;                                   ///< the first ten of them, with shard and reason
  std::vector<std::uint64_t> given_up;                             ///< shards that ended three workers
  bool stopped = false;
  double seconds = 0.0;

  bool complete() const { return shards_before + shards_played == shards; }
};

/// Has workers, made where a shard is missing, play every shard that is asked for and not yet done, and keeps what they
/// hand in, shard by shard. Memory does not grow with the number of runs (but for a bit a shard). Throws InputError
/// where `results` cannot be written, or workers are lost over and over: more than three times each, and no result
/// between.
CampaignSummary run_campaign(const Plan& plan, Results& results, const MakeWorkers& make_workers,
                             const CampaignOptions& options);

}  // namespace palpate::study
