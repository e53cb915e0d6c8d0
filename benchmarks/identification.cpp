// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <string>

#include "tests/identification/stiffness_setups.hpp"

/// Stiffness from ten dead loads on the paper's catheter, points every centimetre, the file 30 % off: time (CPU),
/// evaluations of the cost and integrations of a rod, by method, unknowns and what else is uncertain.
namespace palpate {
namespace {

using Unknowns = StiffnessOptions::Unknowns;
using Method = StiffnessOptions::Method;

void identify(benchmark::State& state, double sigma_m, bool uncertain_setup, const StiffnessOptions& options) {
  const Rod truth = test::paper_catheter(19.41);
  std::mt19937_64 random(1);
  const auto cases = test::with_noise(test::hang(truth, test::ten_forces_N(), test::every_centimetre(truth), sigma_m),
                                      sigma_m, random);
  Catheter stated = test::catheter_of(truth);
  if (uncertain_setup) stated = test::with_uncertain_setup(stated);
  test::scale_stiffness(stated.rod, {1.3, 1.3, 1.3});
  StiffnessFit fit;
  for (auto _ : state) {
    fit = identify_stiffness(stated, cases, options);
    benchmark::DoNotOptimize(fit);
  }
  state.counters["cost"] = fit.cost_evaluations;
  state.counters["rods"] = fit.rod_evaluations;
}

void register_rows() {
  constexpr std::pair<const char*, Method> methods[] = {{"levenberg_marquardt", Method::kLevenbergMarquardt},
                                                        {"nelder_mead", Method::kNelderMead}};
  constexpr std::pair<const char*, Unknowns> unknowns[] = {
      {"scale", Unknowns::kScale}, {"EI1_EI2", Unknowns::kBending}, {"EI1_EI2_GJ", Unknowns::kBendingAndTorsion}};
  for (const auto& [unknown, u] : unknowns)
    for (const bool uncertain : {false, true})
      for (const auto& [method, m] : methods) {
        const std::string name = std::string("stiffness/") + unknown + (uncertain ? "/uncertain/" : "/exact/") + method;
        benchmark::RegisterBenchmark(name.c_str(), identify, 0.28e-3, uncertain,
                                     StiffnessOptions{.unknowns = u, .method = m})
            ->Unit(benchmark::kMillisecond);
      }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::register_rows();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
