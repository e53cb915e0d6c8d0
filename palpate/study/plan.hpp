// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <palpate/study/measures.hpp>
#include <string>
#include <vector>

/// A Monte-Carlo campaign: which numbers vary, how often each point of them is played, what is measured.
namespace palpate::study {

enum class Model : std::uint8_t {
  kScenario,      ///< a virtual experiment played and estimated: milliseconds to seconds a run
  kSingleUpdate,  ///< one frame, one update from another force: tens of microseconds a run
};

/// The files that a run is made of, as TOML; what varies is put into copies of them.
struct Documents {
  toml::table scenario, catheter;
  toml::table update;  ///< [update] of the study file
};

/// One number (or word) that varies.
struct Parameter {
  std::string name;                    ///< as settings.hpp reads it
  std::vector<nlohmann::json> values;  ///< of the grid; empty where it is sampled
  double from = 0.0, to = 0.0;         ///< of the Latin hypercube
  bool logarithmic = false;

  bool sampled() const { return values.empty(); }
};

/// Of a sampled one, at a share in [0, 1] of its range.
double between(const Parameter& parameter, double share);

struct Plan {
  std::string name, source;  ///< the study's title; its file
  Model model = Model::kScenario;
  std::string scenario_source, catheter_source;
  Documents base;
  std::vector<Parameter> parameters;
  std::vector<Measure> measures;
  std::uint64_t seed = 1;
  std::uint64_t samples = 1;     ///< points of the Latin hypercube, for each point of the grid
  std::uint64_t repeats = 1;     ///< runs a point
  std::uint64_t shard_runs = 0;  ///< runs that are handed out, and stored, together
  bool common_seeds = false;     ///< repeat k has the same seed at every point: differences between points are sharper
  double skip_s = 1.0;           ///< of every run, before it is judged

  std::uint64_t grid_points() const;
  std::uint64_t points() const { return grid_points() * samples; }
  std::uint64_t runs() const { return points() * repeats; }
  std::uint64_t shards() const { return (runs() + shard_runs - 1) / shard_runs; }
};

/// Which run it is. Points count through the samples first, then through the grid, its last parameter fastest.
struct RunKey {
  std::uint64_t run = 0, point = 0, repeat = 0;
  std::uint64_t seed = 0;  ///< below 2^53; depends on the plan's seed and on `run` alone (or `repeat`)
};
RunKey run_key(const Plan& plan, std::uint64_t run);

/// Values of all parameters at a point, in the order of Plan::parameters. Random access, nothing is stored.
std::vector<nlohmann::json> point_values(const Plan& plan, std::uint64_t point);

/// The shards that are asked for: those with number i where i mod parts = part. Which ones are asked for changes none
/// of what they give.
struct Part {
  std::uint64_t part = 0, parts = 1;
  bool holds(std::uint64_t shard) const { return shard % parts == part; }
};

struct RunRange {
  std::uint64_t first = 0, end = 0;
};
RunRange shard_range(const Plan& plan, std::uint64_t shard);

}  // namespace palpate::study
