// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <palpate/observer/force_observer.hpp>
#include <palpate/simulation/virtual_tracker.hpp>
#include <span>
#include <tests/sensing/virtual_setups.hpp>

/// Runs of the observer over simulated recordings.
namespace palpate::test {

inline std::vector<Estimate> run(const Catheter& catheter, const ObserverOptions& options,
                                 std::span<const TrackerFrame> frames) {
  ForceObserver observer(catheter, options);
  std::vector<Estimate> out;
  for (const TrackerFrame& frame : frames) out.push_back(observer.update(frame));
  return out;
}

inline ForceSchedule constant_force(const Vector3d& force_tip_N) {
  return [=](double) { return force_tip_N; };
}

/// What the estimate says of the state: bit for bit.
inline bool same_state(const Estimate& a, const Estimate& b) {
  const auto same = [](const auto& x, const auto& y) {
    return std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
  };
  return same(a.force_tip_N, b.force_tip_N) && same(a.covariance_tip_N2, b.covariance_tip_N2) &&
         same(a.force_base_N, b.force_base_N);
}

inline double nees(const Estimate& estimate, const Vector3d& truth_tip_N) {
  return normalised_error_squared(estimate.force_tip_N - truth_tip_N, estimate.covariance_tip_N2);
}

/// Share of the estimates after the first second (40 frames) whose every axis lies within `sigmas` of the truth.
inline double share_within(double sigmas, const std::vector<Estimate>& estimates, const VirtualRecording& recording) {
  constexpr std::size_t kFirst = 40;
  std::size_t inside = 0;
  for (std::size_t i = kFirst; i < estimates.size(); ++i) {
    const Eigen::Array3d error = (estimates[i].force_tip_N - recording.force_tip_N[i]).array().abs();
    const Eigen::Array3d sigma = estimates[i].covariance_tip_N2.diagonal().array().sqrt();
    inside += (error <= sigmas * sigma).all() ? 1 : 0;
  }
  return static_cast<double>(inside) / static_cast<double>(estimates.size() - kFirst);
}

inline constexpr std::array kEveryMethod{Method::kEkf, Method::kIekf, Method::kIaekf, Method::kUkf};

inline const char* name_of(Method method) {
  constexpr std::array names{"ekf", "iekf", "iaekf", "ukf"};
  return names[static_cast<std::size_t>(method)];
}

}  // namespace palpate::test
