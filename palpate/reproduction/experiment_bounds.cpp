// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <limits>
#include <palpate/estimation/motion_filter.hpp>
#include <palpate/estimation/smoother.hpp>
#include <palpate/reproduction/experiment_bounds.hpp>
#include <palpate/sensing/shape_model.hpp>

namespace palpate::reproduction {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

Vector3d variances(const Matrix3d& information) { return information.llt().solve(Matrix3d::Identity()).diagonal(); }

/// Of white acceleration that moves each axis as far as the truth: [N/s per sqrt(s)]. An axis that stands still gets a
/// ten-thousandth of a newton, for the model wants a number.
Vector3d acceleration_of(std::span<const Vector3d> force_N, double frame_s) {
  Vector3d sum = Vector3d::Zero();
  const std::size_t n = force_N.size();
  for (std::size_t i = 2; i < n; ++i)
    sum += ((force_N[i] - 2.0 * force_N[i - 1] + force_N[i - 2]) / frame_s).cwiseAbs2();
  constexpr double kStill = 1e-4;
  return (sum / (static_cast<double>(n - 2) * frame_s)).cwiseSqrt().cwiseMax(kStill);
}

}  // namespace

std::vector<Matrix3d> force_information(const Catheter& catheter, std::span<const TrackerFrame> frames,
                                        std::span<const Vector3d> force_tip_N) {
  ShapeModel model(catheter, MeasurementKind::kPoses, {}, Accuracy::kReference);
  Measurement measurement;
  Linearization at;
  ResidualMatrix R;
  std::vector<Matrix3d> out;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    register_frame(catheter, frames[i], measurement);
    model.select(measurement, ~0U);
    model.linearize(force_tip_N[i], at);
    model.noise(R);
    out.emplace_back(at.jacobian.transpose() * R.llt().solve(at.jacobian));
  }
  return out;
}

ForceBounds force_bounds(std::span<const Matrix3d> information_per_N2, std::span<const Vector3d> force_tip_N,
                         double frame_s, std::size_t first) {
  MotionFilter filter(MotionOptions{.rate_memory_s = kForever}, acceleration_of(force_tip_N, frame_s));
  RecordingSmoother smoother(filter.model());
  Vector3d frame = Vector3d::Zero(), online = frame, smoothed = frame;
  for (std::size_t i = 0; i < information_per_N2.size(); ++i) {
    filter.predict(i == 0 ? 0.0 : frame_s);
    filter.absorb(ForceLikelihood{information_per_N2[i], information_per_N2[i] * force_tip_N[i]}, false);
    smoother.push(filter.step(), filter.belief());
    if (i < first) continue;
    frame += variances(information_per_N2[i]);
    online += filter.reported().covariance_N2.diagonal();
  }
  const std::vector<SmoothedFrame> all = smoother.smooth();
  for (std::size_t i = first; i < all.size(); ++i) smoothed += all[i].force.covariance_N2.diagonal();
  const auto n = static_cast<double>(all.size() - first);
  return {(frame / n).cwiseSqrt(), (online / n).cwiseSqrt(), (smoothed / n).cwiseSqrt(), frame.cwiseSqrt() / n};
}

}  // namespace palpate::reproduction
