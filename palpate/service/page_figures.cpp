// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/service/page_figures.hpp>

namespace palpate::service {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kZ95 = 1.959964;
constexpr double kBeatEvery_s = 1.0;

constexpr std::size_t history_column(std::string_view name) {
  return static_cast<std::size_t>(std::find(kPageHistory.begin(), kPageHistory.end(), name) - kPageHistory.begin());
}
constexpr std::size_t kTime = history_column("time_s"), kSize = history_column("size_N");
static_assert(kTime < kPageHistory.size() && kSize < kPageHistory.size());

/// theta = atan2(l, a) with a = -axial:  d theta = (a dl - l da) / (l^2 + a^2).
double sigma_of_angle(const Vector3d& F, const Matrix3d& P, const ForceParts& parts) {
  const double l = parts.lateral_N, a = -parts.axial_N;
  const Eigen::Vector2d u = l > 0.0 ? Eigen::Vector2d(F.head<2>() / l) : Eigen::Vector2d::Zero();
  const double covariance = -u.dot(P.topRightCorner<2, 1>());
  const double squared =
      a * a * parts.sigma_lateral_N * parts.sigma_lateral_N + l * l * P(2, 2) - 2.0 * a * l * covariance;
  return std::sqrt(std::max(0.0, squared)) / (l * l + a * a);
}

}  // namespace

ForceParts::ForceParts()
    : size_N(kNaN),
      sigma_size_N(kNaN),
      axial_N(kNaN),
      sigma_axial_N(kNaN),
      lateral_N(kNaN),
      sigma_lateral_N(kNaN),
      angle_rad(kNaN),
      sigma_angle_rad(kNaN) {}

ForceParts::ForceParts(const Estimate& estimate) : ForceParts() {
  const Vector3d& F = estimate.force_tip_N;
  const Matrix3d& P = estimate.covariance_tip_N2;
  if (!is_measured(estimate.status) || !F.allFinite() || !P.allFinite()) return;
  measured = true;
  size_N = F.norm();
  sigma_size_N = sigma_of_norm(F, P);
  axial_N = F.z();
  sigma_axial_N = std::sqrt(P(2, 2));
  lateral_N = F.head<2>().norm();
  sigma_lateral_N = sigma_of_norm(F.head<2>(), P.topLeftCorner<2, 2>());
  if (size_N < kZ95 * sigma_size_N) return;
  angle_rad = std::atan2(lateral_N, -axial_N);
  sigma_angle_rad = sigma_of_angle(F, P, *this);
}

void LiveFigures::take(const session::LiveRecord& record) {
  const double time_s = record.output_time_s;
  latest_ = record.kind == session::LiveRecord::Kind::kFrame ? ForceParts(record.estimate) : ForceParts();
  const ForceSize size{time_s, latest_.size_N, latest_.sigma_size_N, latest_.measured};
  if (const auto ended = finder_.add(size)) last_contact_ = *ended;
  integral_.add(size);
  if (latest_.measured) beats_.add(time_s, latest_.size_N);
  if (time_s < beat_due_s_) return;
  beat_due_s_ = time_s + kBeatEvery_s;
  beat_ = beats_.find();
}

void PageHistory::take(const Row& row) {
  const double step = std::floor(row[kTime] / kPageHistoryStep_s);
  if (step > step_) {
    step_ = step;
    if (rows_.size() < kMostRows) {
      rows_.push_back(row);
    } else {
      rows_[oldest_] = row;
      oldest_ = (oldest_ + 1) % kMostRows;
    }
    return;
  }
  Row& newest = rows_[(oldest_ + rows_.size() - 1) % rows_.size()];
  if (step == step_ && !(newest[kSize] >= row[kSize]) && !std::isnan(row[kSize])) newest = row;
}

void PageHistory::append_to(std::vector<double>& out) const {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[(oldest_ + i) % rows_.size()];
    out.insert(out.end(), row.begin(), row.end());
  }
}

}  // namespace palpate::service
