// SPDX-License-Identifier: Apache-2.0
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <benchmarks/course.hpp>
#include <benchmarks/textbook_setup.hpp>
#include <benchmarks/textbook_v3.hpp>
#include <vector>

/// The yardstick as the compiler makes it for a newer processor, beside the rows of claims.cpp.
namespace palpate {
namespace {

bool has_x86_64_v3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
}

template <std::size_t n>
std::array<double, n> numbers(const auto& matrix) {
  std::array<double, n> out;
  std::copy_n(matrix.eval().data(), n, out.begin());
  return out;
}

textbook_v3::Shaft v3_shaft() {
  const textbook::Shaft s = textbook::shaft_of(paper_catheter());
  return {s.length_m, s.behind_m, numbers<3>(s.stiffness_Nm2), numbers<3>(s.precurvature_per_m)};
}

textbook_v3::SensorPoses v3_poses(const textbook::SensorPoses& poses) {
  return {numbers<9>(poses.tip.R), numbers<9>(poses.behind.R), numbers<3>(poses.tip.p), numbers<3>(poses.behind.p)};
}

void textbook_rod_v3(benchmark::State& state) {
  if (!has_x86_64_v3()) return state.SkipWithError("this processor has no AVX2");
  const textbook_v3::Shaft shaft = v3_shaft();
  std::array<double, 3> force_tip_N{0.03, 0.03, -0.1};
  for (auto _ : state) {
    force_tip_N[0] += 1e-9;
    benchmark::DoNotOptimize(textbook_v3::solve_rod(shaft, force_tip_N));
  }
}
BENCHMARK(textbook_rod_v3)->Name("textbook/rod/v3");

/// The same updates; the two must agree, or one of them is not the textbook.
void textbook_update_v3(benchmark::State& state) {
  if (!has_x86_64_v3()) return state.SkipWithError("this processor has no AVX2");
  Course course(MeasurementKind::kPoses);
  const textbook_v3::Shaft shaft = v3_shaft();
  const auto information = textbook::noise_information<textbook::kPoseRows>(course.model);
  const std::array<double, 144> information_v3 = numbers<144>(information);
  std::vector<textbook_v3::SensorPoses> frames;
  for (const Measurement& frame : course.frames) frames.push_back(v3_poses(textbook::poses_of(frame)));
  textbook_v3::Belief belief{{}, numbers<9>(kWalk_N2)};
  const textbook::Belief plain =
      textbook::iekf_update<textbook::kPoseRows>(textbook::shaft_of(course.catheter), {Vector3d::Zero(), kWalk_N2},
                                                 textbook::poses_of(course.frames[0]), information);
  const textbook_v3::Belief wide = textbook_v3::iekf_update(shaft, belief, frames[0], information_v3);
  if (!(Vector3d(wide.force_tip_N.data()) - plain.force_tip_N).isZero(1e-9))
    return state.SkipWithError("textbook/v3 is not the textbook");
  std::size_t next = 0;
  for (auto _ : state) {
    for (const std::size_t i : {0, 4, 8}) belief.covariance_N2[i] += kWalk_N2(0, 0);
    belief = textbook_v3::iekf_update(shaft, belief, frames[next], information_v3);
    benchmark::DoNotOptimize(belief);
    next = (next + 1) % frames.size();
  }
  state.counters["rods"] = textbook::kIterations * 7;
}
BENCHMARK(textbook_update_v3)->Name("textbook/update/poses/v3");

}  // namespace
}  // namespace palpate
