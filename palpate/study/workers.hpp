// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <palpate/study/plan.hpp>
#include <palpate/study/shard.hpp>
#include <string>

namespace palpate::study {

/// What became of a shard that was given away, or of the wait for one.
struct WorkerEvent {
  enum class Kind : std::uint8_t {
    kResult,
    kLost,     ///< the worker ended, its shard is not done; another one has taken its place
    kNothing,  ///< nobody said anything for a while, or a signal came
  };
  Kind kind = Kind::kNothing;
  int worker = 0;
  ShardResult result;
  std::uint64_t shard = 0;  ///< that was lost
  std::string reason;       ///< how the worker ended
};

/// Those who play shards. Each does one at a time.
class Workers {
 public:
  virtual ~Workers() = default;
  virtual int count() const = 0;
  /// Precondition: the worker has nothing to do.
  virtual void give(int worker, std::uint64_t shard) = 0;
  /// At most a fifth of a second.
  virtual WorkerEvent wait() = 0;
};

/// `count` processes forked from this one, which end with it, however it ends. `in_child`: called first in each, to let
/// go of what is the parent's alone. The plan must outlive them. Throws InputError where no process can be made.
std::unique_ptr<Workers> fork_workers(const Plan& plan, int count, const std::function<void()>& in_child);

}  // namespace palpate::study
