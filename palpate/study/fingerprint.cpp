// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <palpate/rod/instruction_set.hpp>
#include <palpate/rod/statics.hpp>
#include <palpate/study/counter_random.hpp>
#include <palpate/study/fingerprint.hpp>
#include <palpate/study/identity.hpp>
#include <palpate/study/shard.hpp>

namespace palpate::study {

namespace {

constexpr std::uint64_t kArguments = 10000, kRods = 50, kUpdates = 64, kScenarios = 2;

template <typename Numbers>
void put(std::string& bytes, const Numbers& numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()),
               sizeof(double) * static_cast<std::size_t>(numbers.size()));
}

std::string function_values() {
  std::string bytes;
  for (std::uint64_t i = 0; i < kArguments; ++i) {
    const double u = unit(mix(1, i)), v = unit(mix(2, i)), angle = 20.0 * u - 10.0;
    put(bytes, std::array{std::exp(angle), std::log(0.001 + 4.0 * u), std::sin(angle), std::cos(angle), std::cbrt(u),
                          std::atan2(u - 0.5, v - 0.5), std::pow(0.1 + 2.0 * u, 6.0 * v - 3.0)});
  }
  return bytes;
}

/// The paper's catheter, bent, under forces of up to half a newton an axis, as the filters and as the truth solve it.
std::string rod_values() {
  const Rod rod = uniform_rod(0.1, {0.2612e-3, 0.16664e-3, 0.1645e-3}, {24.57, 0.0, 0.0});
  const std::array<double, 2> stations_m{0.0653, 0.1};
  LoadDirections<3> directions;
  directions.force_tip_N.setIdentity();
  std::string bytes;
  for (const Accuracy accuracy : {Accuracy::kRealtime, Accuracy::kReference}) {
    const RodSolver solver(rod, stations_m, accuracy);
    RodSolution<3> solution = solver.make_solution<3>();
    for (std::uint64_t i = 0; i < kRods; ++i) {
      const auto force_N = [i](std::uint64_t axis) { return unit(mix(3 + axis, i)) - 0.5; };
      solver.solve<3>({.force_tip_N = {force_N(0), force_N(1), force_N(2)}}, directions, solution);
      for (std::size_t k = 0; k < stations_m.size(); ++k) {
        put(bytes, solution.points[k].T_base_local.p);
        put(bytes, solution.points[k].T_base_local.R);
        put(bytes, solution.tangents[k].position_m);
        put(bytes, solution.tangents[k].rotation);
      }
    }
  }
  return bytes;
}

}  // namespace

std::string fingerprint(const Plan& plan, RunModel& model) {
  const std::uint64_t most = plan.model == Model::kScenario ? kScenarios : kUpdates;
  const std::uint64_t count = std::min(most, plan.runs());
  ShardResult probes{.shard = 0, .rows = {}};
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t run = i * (plan.runs() - 1) / std::max<std::uint64_t>(1, count - 1);
    probes.rows.push_back(play(plan, run, [&model](const RunKey& key) { return model.probe(key); }));
  }
  const std::string instructions = name(preferred_instruction_set());
  return sha256(plan_id(plan) + instructions + function_values() + rod_values() + encode(probes));
}

}  // namespace palpate::study
