// SPDX-License-Identifier: Apache-2.0
#include <benchmarks/textbook.hpp>
#include <benchmarks/textbook_v3.hpp>

#if !defined(__AVX2__) || !defined(__FMA__) || !defined(palpate)
#error "to be built with -march=x86-64-v3 and the namespaces renamed: benchmarks/CMakeLists.txt"
#endif

namespace textbook_v3 {
namespace {

namespace textbook = palpate::textbook;
using Vector = Eigen::Map<const Eigen::Vector3d>;
using Matrix = Eigen::Map<const Eigen::Matrix3d>;

textbook::Shaft of(const Shaft& s) {
  return {s.length_m, s.behind_m, Vector(s.stiffness_Nm2.data()), Vector(s.precurvature_per_m.data())};
}

template <std::size_t n, class M>
void copy(const M& from, std::array<double, n>& to) {
  Eigen::Map<M>(to.data()) = from;
}

}  // namespace

SensorPoses solve_rod(const Shaft& shaft, const std::array<double, 3>& force_tip_N) {
  const textbook::SensorPoses poses = textbook::solve_rod(of(shaft), Vector(force_tip_N.data()));
  SensorPoses out;
  copy(poses.tip.R, out.R_tip);
  copy(poses.tip.p, out.p_tip_m);
  copy(poses.behind.R, out.R_behind);
  copy(poses.behind.p, out.p_behind_m);
  return out;
}

Belief iekf_update(const Shaft& shaft, const Belief& prior, const SensorPoses& measured,
                   const std::array<double, 144>& noise_information) {
  const textbook::Belief posterior = textbook::iekf_update<textbook::kPoseRows>(
      of(shaft), {Vector(prior.force_tip_N.data()), Matrix(prior.covariance_N2.data())},
      {{Matrix(measured.R_tip.data()), Vector(measured.p_tip_m.data())},
       {Matrix(measured.R_behind.data()), Vector(measured.p_behind_m.data())}},
      Eigen::Map<const Eigen::Matrix<double, 12, 12>>(noise_information.data()));
  Belief out;
  copy(posterior.force_tip_N, out.force_tip_N);
  copy(posterior.covariance_N2, out.covariance_N2);
  return out;
}

}  // namespace textbook_v3
