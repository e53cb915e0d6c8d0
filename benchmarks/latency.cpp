// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <benchmarks/machine.hpp>
#include <benchmarks/paper_catheter.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <tests/observer/allocation_counter.hpp>
#include <tests/shared_recordings.hpp>

/// A million updates of the observer on the heartbeat recording, again and again, its time running on: how long each
/// took, how many rods, and whether the heap or a new page was touched. Exit code 1 where one was.
namespace palpate::latency {
namespace {

struct Options {
  std::size_t updates = 1'000'000, warm_up = 20'000;
  bool simulated = false, json = false;
  int core = -1;
  std::size_t allocate_every = 0;
};

/// What the system was asked for and granted.
struct Setting {
  int core = -1;
  bool locked = false;
  Times overhead;  ///< of reading the clocks; taken off every time
};

struct Scenario {
  std::string name;
  Catheter catheter;
  std::vector<TrackerFrame> frames;
};

/// The recording repeats 1200 frames; the simulation 40 000, each with noise of its own.
Scenario scenario(bool simulated) {
  if (!simulated && std::filesystem::exists(test::shared_data(test::kRecordings))) {
    test::SharedRecording heartbeat = test::shared_recording("heartbeat");
    return {"recordings/heartbeat", heartbeat.catheter, std::move(heartbeat.frames)};
  }
  const Catheter catheter = paper_catheter();
  return {"simulated beating wall", catheter,
          simulate_tracker(catheter, beating_wall_force, {.rate_hz = 40.0, .duration_s = 1000.0}).frames};
}

/// Frames in a ring; after each turn the clock runs on.
class Ring {
 public:
  explicit Ring(std::vector<TrackerFrame>& frames)
      : frames_(frames), turn_s_(frames.back().time_s - frames.front().time_s + 0.025) {}

  const TrackerFrame& next() {
    TrackerFrame& frame = frames_[at_];
    at_ = (at_ + 1) % frames_.size();
    frame.time_s += turn_s_;
    return frame;
  }

 private:
  std::vector<TrackerFrame>& frames_;
  double turn_s_;
  std::size_t at_ = 0;
};

/// A block that the heap takes from the system: an allocation and a page fault that no optimiser removes.
void allocate(std::vector<void*>& kept) {
  kept.push_back(std::malloc(std::size_t{64} << 20));
  if (kept.back() != nullptr) *static_cast<volatile char*>(kept.back()) = 1;
}

Record run(Scenario& scenario, const Options& options, Setting& setting) {
  ForceObserver observer(scenario.catheter, {});
  Ring ring(scenario.frames);
  Record record(options.updates);
  const auto update = [&](std::size_t i) {
    const TrackerFrame& frame = ring.next();
    const Times times = timed([&] { record.evaluations[i] = observer.update(frame).evaluations; });
    record.wall_us[i] = times.wall_us - setting.overhead.wall_us;
    record.cpu_us[i] = times.cpu_us - setting.overhead.cpu_us;
  };
  for (std::size_t i = 0; i < options.warm_up; ++i) update(i % options.updates);
  std::vector<void*> kept;
  if (options.allocate_every > 0) kept.reserve(options.updates / options.allocate_every + 1);
  setting.locked = lock_memory();

  const test::CountAllocations allocations;
  const rusage before = usage();
  for (std::size_t i = 0; i < options.updates; ++i) {
    update(i);
    if (options.allocate_every > 0 && i % options.allocate_every == 0) allocate(kept);
  }
  const rusage after = usage();
  record.allocations = static_cast<std::int64_t>(allocations.so_far());
  record.minor_faults = after.ru_minflt - before.ru_minflt;
  record.major_faults = after.ru_majflt - before.ru_majflt;
  record.preemptions = after.ru_nivcsw - before.ru_nivcsw;
  for (void* block : kept) std::free(block);
  return record;
}

struct Line {
  const char *name, *key;
  Percentiles p;
};

std::vector<Line> lines(const Record& record, std::size_t frames) {
  return {{"wall time [us]", "wall_us", percentiles(record.wall_us)},
          {"CPU time [us]", "cpu_us", percentiles(record.cpu_us)},
          {"least CPU time of each frame [us]", "least_cpu_us", percentiles(least_by_frame(record.cpu_us, frames))},
          {"rods", "evaluations", percentiles(record.evaluations)}};
}

bool passed(const Record& r) { return r.allocations == 0 && r.minor_faults == 0 && r.major_faults == 0; }

nlohmann::json json_of(const Record& record, const Scenario& scenario, const Setting& setting) {
  nlohmann::json j{{"scenario", scenario.name},
                   {"distinct_frames", scenario.frames.size()},
                   {"updates", record.wall_us.size()},
                   {"allocations", record.allocations},
                   {"minor_page_faults", record.minor_faults},
                   {"major_page_faults", record.major_faults},
                   {"preemptions", record.preemptions},
                   {"core", setting.core},
                   {"memory_locked", setting.locked},
                   {"clock_us", setting.overhead.wall_us},
                   {"passed", passed(record)}};
  for (const Line& line : lines(record, scenario.frames.size()))
    j[line.key] = {{"p50", line.p.p50},
                   {"p99", line.p.p99},
                   {"p99_9", line.p.p99_9},
                   {"max", line.p.max},
                   {"p99_9_over_p50", line.p.tail()}};
  return j;
}

std::string text_of(const Record& record, const Scenario& scenario, const Setting& setting) {
  std::string text = fmt::format("{} updates on {} ({} distinct frames)\n\n{:36}{:>10}{:>10}{:>10}{:>10}{:>12}\n",
                                 record.wall_us.size(), scenario.name, scenario.frames.size(), "", "p50", "p99",
                                 "p99.9", "max", "p99.9/p50");
  for (const Line& line : lines(record, scenario.frames.size()))
    text += fmt::format("{:36}{:10.1f}{:10.1f}{:10.1f}{:10.1f}{:12.2f}\n", line.name, line.p.p50, line.p.p99,
                        line.p.p99_9, line.p.max, line.p.tail());
  text += fmt::format("\n{}, memory {}; {:.3f} us of reading the clock taken off\n",
                      setting.core < 0 ? "on no core of its own" : fmt::format("on core {}", setting.core),
                      setting.locked ? "locked" : "not locked", setting.overhead.wall_us);
  return text + fmt::format("allocations {}, page faults {} minor, {} major, preempted {} times: {}\n",
                            record.allocations, record.minor_faults, record.major_faults, record.preemptions,
                            passed(record) ? "passed" : "FAILED");
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app{"Latency of a million updates on the heartbeat: percentiles, allocations, page faults."};
  app.footer("Example: benchmark_latency --updates 1000000 --json");
  app.add_option("--updates", options.updates, "updates that count")->check(CLI::PositiveNumber);
  app.add_option("--warm-up", options.warm_up, "updates before them");
  app.add_flag("--simulated", options.simulated, "the simulated beating wall, though the recording is there");
  app.add_option("--core", options.core, "core to stay on; -1: the one it is on")
      ->check(CLI::Range(-1, CPU_SETSIZE - 1));
  app.add_option("--allocate-every", options.allocate_every,
                 "allocate 64 MB of address space in the loop: proof that it would be seen");
  app.add_flag("--json", options.json, "machine-readable");
  CLI11_PARSE(app, argc, argv);

  Scenario s = scenario(options.simulated);
  Setting setting{.core = pin(options.core), .overhead = clock_overhead()};
  const Record record = run(s, options, setting);
  if (options.json)
    fmt::print("{}\n", json_of(record, s, setting).dump(2));
  else
    fmt::print("{}", text_of(record, s, setting));
  return passed(record) ? 0 : 1;
}

}  // namespace
}  // namespace palpate::latency

int main(int argc, char** argv) {
  try {
    return palpate::latency::main_of(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
