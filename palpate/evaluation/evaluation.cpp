// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <palpate/evaluation/evaluation.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

namespace {

bool was_updated(EstimateStatus status) {
  return status == EstimateStatus::kUpdated || status == EstimateStatus::kReseeded ||
         status == EstimateStatus::kAmbiguous;
}

/// Of the first frame that has a time at all; NaN where none has.
double first_time_s(std::span<const EstimateRow> estimate) {
  for (const EstimateRow& row : estimate)
    if (std::isfinite(row.time_s)) return row.time_s;
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Evaluation evaluate(std::span<const EstimateRow> estimate, const ForceTrace& truth, double skip_s) {
  Evaluation out;
  Eigen::Array3d sum = Eigen::Array3d::Zero(), squares = sum, largest = sum, inside_95 = sum, inside_3 = sum;
  const double first_s = first_time_s(estimate);
  for (const EstimateRow& row : estimate) {
    if (!(row.time_s >= first_s + skip_s)) continue;
    const ForceTrace::Sample sample = truth.interpolate(row.time_s);
    if (!sample.inside) {
      ++out.outside_truth;
      continue;
    }
    const Vector3d error = row.force_tip_N - sample.force_tip_N;
    const Eigen::Array3d size = error.array().abs(), sigma = row.covariance_tip_N2.diagonal().array().sqrt();
    ++out.frames;
    out.updated += was_updated(row.status) ? 1 : 0;
    sum += error.array();
    squares += error.array().square();
    largest = largest.max(size);
    inside_95 += (size <= 1.959964 * sigma).cast<double>();
    inside_3 += (size <= 3.0 * sigma).cast<double>();
    const double nees = normalised_error_squared(error, row.covariance_tip_N2);
    if (std::isfinite(nees))
      out.mean_nees += nees;
    else
      ++out.indefinite;
  }
  if (out.frames == 0)
    throw InputError(fmt::format(
        "{}: no frame to judge: expected force samples between the estimate's first second and its end", truth.source));
  const auto n = static_cast<double>(out.frames);
  const Eigen::Array3d mean = sum / n;
  out.mean_N = mean;
  out.rmse_N = (squares / n).sqrt();
  out.sigma_N = (squares / n - mean.square()).max(0.0).sqrt();
  out.largest_N = largest;
  out.inside_95 = inside_95 / n;
  out.inside_3_sigma = inside_3 / n;
  out.mean_nees /= static_cast<double>(out.frames - out.indefinite);
  return out;
}

}  // namespace palpate
