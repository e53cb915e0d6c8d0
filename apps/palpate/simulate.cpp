// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <list>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/recording/csv_writers.hpp>
#include <palpate/recording/text_table.hpp>
#include <palpate/recording/virtual_run_csv.hpp>

#include "file_paths.hpp"
#include "progress_line.hpp"
#include "simulate_report.hpp"
#include "verbs.hpp"

namespace palpate::app {

namespace {

struct Options {
  std::string scenario, out, plot, seed;
  ScenarioChanges changes;
  bool stable_only = false, json = false;
};

/// Files of one experiment: all of them, or none.
class Files {
 public:
  explicit Files(std::string name) : name_(std::move(name)) {}
  OutputFile& add(const char* ending) {
    names_.push_back(name_ + ending);
    return files_.emplace_back(names_.back());
  }
  void leave_out(const char* ending) { left_out_.push_back(name_ + ending); }
  void commit() {
    for (OutputFile& file : files_) file.commit();
  }
  /// An older run's files that now stand beside a recording that they do not belong to.
  std::vector<std::string> strangers() const {
    std::vector<std::string> warnings;
    std::error_code ignored;
    for (const std::string& name : left_out_)
      if (std::filesystem::exists(name, ignored))
        warnings.push_back(fmt::format("{}: is not of this run, which has nothing to tell there", name));
    return warnings;
  }
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::string name_;
  std::vector<std::string> names_, left_out_;
  std::list<OutputFile> files_;
};

constexpr const char* kTracker = ".tracker.csv";
constexpr const char* kForce = ".force.csv";
constexpr const char* kTendon = ".tendon.csv";
constexpr const char* kStiffness = ".stiffness.csv";
constexpr const char* kEvents = ".events.csv";
constexpr const char* kCatheter = ".catheter.toml";

void refuse_bad_changes(const ScenarioChanges& changes) {
  const auto require = [](const char* flag, const std::optional<double>& value, double least, double most) {
    if (value && !(*value >= least && *value <= most))
      throw InputError(fmt::format("{} {}: expected {} to {}", flag, *value, least, most));
  };
  require("--duration", changes.duration_s, 1e-3, 86400.0);
  require("--rate", changes.rate_hz, 1e-3, 1e4);
}

/// As the scenario's own seed: a whole number that JSON, too, holds without loss.
std::optional<std::uint64_t> parse_seed(const std::string& text) {
  if (text.empty()) return std::nullopt;
  constexpr std::uint64_t kMost = 1ULL << 53U;
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, seed);
  if (error != std::errc{} || rest != end || seed > kMost)
    throw InputError(fmt::format("--seed {}: expected a whole number, 0 to 2^53", printable(text)));
  return seed;
}

std::vector<OutputPath> output_paths(const Options& options) {
  const std::string last = std::filesystem::path(options.out).filename().string();
  if (last.empty() || last == "." || last == "..")
    throw InputError(fmt::format("--out {}: expected a name, to which .tracker.csv and others are added", options.out));
  std::vector<OutputPath> outputs;
  for (const char* ending : {kTracker, kForce, kTendon, kStiffness, kEvents, kCatheter})
    outputs.push_back({"--out", options.out + ending});
  if (!options.plot.empty()) outputs.push_back({"--plot", options.plot});
  return outputs;
}

/// The duration may be too short, or nothing be left of the frames.
[[noreturn]] void refuse_no_frames(const Options& options, const Scenario& scenario) {
  const double rate_hz = scenario.tracker.rate_hz;
  if (std::llround(scenario.duration_s * rate_hz) > 0)
    throw InputError(
        fmt::format("{}: tracker.dropped_percent = {:g}: expected a frame that is left of {:g} s at {:g} Hz",
                    options.scenario, 100.0 * scenario.tracker.dropped_share, scenario.duration_s, rate_hz));
  const std::string which = options.changes.duration_s
                                ? fmt::format("--duration {}", scenario.duration_s)
                                : fmt::format("{}: scenario.duration_s = {}", options.scenario, scenario.duration_s);
  throw InputError(fmt::format("{}: expected long enough for a frame at {} Hz", which, rate_hz));
}

VirtualRun play(const Options& options, const Scenario& scenario) {
  ProgressLine line("simulate");
  try {
    return run_scenario(scenario,
                        {.stable_only = options.stable_only, .progress = [&line](double share) { line.show(share); }});
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", options.scenario, error.what()));
  }
}

/// The truth has a stiffness of its own to tell: it drifts, or is not the one that is believed.
bool tells_stiffness(const VirtualRun& run, const Catheter& believed) {
  const Section& shaft = believed.rod.first_flexible();
  return !shaft.rigid && std::any_of(run.truth.begin(), run.truth.end(), [&](const Truth& truth) {
    return !truth.stiffness_Nm2.isApprox(shaft.stiffness_Nm2, 1e-9);
  });
}

void write_all(const ScenarioFile& file, const VirtualRun& run, Files& files) {
  write_tracker_csv(files.add(kTracker), file.scenario.catheter, run.frames);
  write_true_force_csv(files.add(kForce), run);
  files.add(kCatheter).write(file.believed_text);
  const auto choose = [&](bool there, const char* ending, void (*write)(OutputFile&, const VirtualRun&)) {
    there ? write(files.add(ending), run) : files.leave_out(ending);
  };
  choose(has_tendon_trace(run), kTendon, write_tendon_csv);
  choose(tells_stiffness(run, file.believed.catheter), kStiffness, write_stiffness_csv);
  choose(!run.events.empty(), kEvents, write_events_csv);
}

std::string estimate_command(const std::string& name, const VirtualRun& run) {
  const std::string tendon = has_tendon_trace(run) ? fmt::format(" --tendon {}{}", name, kTendon) : "";
  return fmt::format("palpate estimate --catheter {0}{1} {0}{2}{3} --out {0}.estimate.csv", name, kCatheter, kTracker,
                     tendon);
}

int run(const Options& options) {
  refuse_bad_changes(options.changes);
  const std::vector<OutputPath> outputs = output_paths(options);
  check_paths({{"scenario", "the scenario", options.scenario}}, outputs);
  const ScenarioFile file = read_scenario_file(options.scenario, options.changes);
  check_paths({{"catheter", "the scenario's catheter file", file.catheter_path.string()}}, outputs);
  const VirtualRun run = play(options, file.scenario);
  if (run.frames.empty()) refuse_no_frames(options, file.scenario);
  Files files(options.out);
  write_all(file, run, files);
  if (!options.plot.empty()) plot::write_figure(true_force_figure(file.scenario, run), options.plot);
  files.commit();
  print_warnings(file.believed.warnings);
  print_warnings(files.strangers());
  const SimulateReport report{&file.scenario, &run, files.names(), estimate_command(options.out, run)};
  options.json ? report.print_json() : report.print();
  return 0;
}

}  // namespace

void add_simulate(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(
      "simulate", "A virtual experiment: a recording as a tracker would make it, and the true force beside it");
  verb->add_option("scenario", options->scenario, "scenario file (TOML)")->type_name("FILE")->required();
  verb->add_option("--out", options->out,
                   "PATH of what is written: PATH.tracker.csv, PATH.force.csv, PATH.catheter.toml, and where there is "
                   "something to tell PATH.tendon.csv, PATH.stiffness.csv, PATH.events.csv")
      ->type_name("PATH")
      ->required();
  verb->add_option("--seed", options->seed, "of all that is drawn, instead of the scenario's")->type_name("UINT");
  verb->add_option("--duration", options->changes.duration_s, "seconds, instead of the scenario's")
      ->type_name("SECONDS");
  verb->add_option("--rate", options->changes.rate_hz, "frames a second, instead of the scenario's")->type_name("HZ");
  verb->add_flag("--noise-free", options->changes.noise_free, "tracker and tendon channel make no error at all");
  verb->add_flag("--stable-only", options->stable_only,
                 "refuse a load path that loses its stability, instead of snapping to another shape");
  verb->add_option("--plot", options->plot, "draw the true force over time (.svg or .png)")->type_name("FILE");
  verb->add_flag("--json", options->json, "print the summary as JSON");
  verb->footer(
      "Example: palpate simulate examples/scenarios/beating_heart.toml --out run\n"
      "         palpate estimate --catheter run.catheter.toml run.tracker.csv --out run.estimate.csv\n"
      "         palpate evaluate --estimate run.estimate.csv --truth run.force.csv");
  verb->callback([options, verb, &exit_code] {
    refuse_empty_values(*verb);
    options->changes.seed = parse_seed(options->seed);
    exit_code = run(*options);
  });
}

}  // namespace palpate::app
