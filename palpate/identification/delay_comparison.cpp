// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/identification/delay_comparison.hpp>
#include <palpate/identification/noise_statistics.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

namespace {

constexpr std::size_t kFewest = 20;
constexpr double kGapSteps = 5.0;

double median_step(std::span<const TimedForce> samples) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < samples.size(); ++i) steps_s.push_back(samples[i].time_s - samples[i - 1].time_s);
  return steps_s.empty() ? 0.0 : quantile(std::move(steps_s), 0.5);
}

/// Sum over lags of the scores' covariance, those farther apart counting less (Bartlett).
template <class Vector>
auto long_run_covariance(const std::vector<Vector>& scores, std::size_t lags) {
  using Square = Eigen::Matrix<double, Vector::RowsAtCompileTime, Vector::RowsAtCompileTime>;
  Square sum = Square::Zero();
  for (std::size_t lag = 0; lag <= lags && lag < scores.size(); ++lag) {
    const double weight = 1.0 - static_cast<double>(lag) / static_cast<double>(lags + 1);
    Square product = Square::Zero();
    for (std::size_t i = lag; i < scores.size(); ++i) product += scores[i] * scores[i - lag].transpose();
    if (lag == 0)
      sum += product;
    else
      sum += weight * (product + product.transpose());
  }
  return sum;
}

[[noreturn]] void refuse_overlap(std::span<const TimedForce> tracker, std::span<const TimedForce> sensor,
                                 std::size_t inside, double max_delay_s) {
  throw InputError(fmt::format(
      "the forces are to be compared within +-{} s: only {} samples of the tracker's ({:.6g} s to {:.6g} s) "
      "lie so far inside the force sensor's ({:.6g} s to {:.6g} s): expected at least {}; a smaller "
      "--max-delay needs less, and are both on one clock?",
      max_delay_s, inside, tracker.front().time_s, tracker.back().time_s, sensor.front().time_s, sensor.back().time_s,
      kFewest));
}

}  // namespace

ForceCurve::ForceCurve(std::span<const TimedForce> samples)
    : samples_(samples), slopes_(samples.size(), Vector3d::Zero()), step_s_(median_step(samples)) {
  for (const TimedForce& sample : samples) times_s_.push_back(sample.time_s);
  const auto chord = [&](std::size_t i) -> Vector3d {
    return (samples[i + 1].force_N - samples[i].force_N) / (samples[i + 1].time_s - samples[i].time_s);
  };
  const std::size_t last = samples.size() - 1;
  slopes_.front() = chord(0);
  slopes_.back() = chord(last - 1);
  for (std::size_t i = 1; i < last; ++i) {
    const double before_s = times_s_[i] - times_s_[i - 1], after_s = times_s_[i + 1] - times_s_[i];
    slopes_[i] = (after_s * chord(i - 1) + before_s * chord(i)) / (before_s + after_s);
  }
}

ForceCurve::Point ForceCurve::at(double time_s) const {
  Point point;
  if (!(time_s >= times_s_.front() && time_s <= times_s_.back())) return point;
  const auto above = std::upper_bound(times_s_.begin(), times_s_.end() - 1, time_s);
  const auto high = static_cast<std::size_t>(above - times_s_.begin()), low = high - 1;
  const double h = times_s_[high] - times_s_[low], u = (time_s - times_s_[low]) / h;
  if (h > kGapSteps * step_s_) return point;
  const Vector3d &from = samples_[low].force_N, &to = samples_[high].force_N;
  const Vector3d m0 = h * slopes_[low], m1 = h * slopes_[high];
  const Vector3d c2 = 3.0 * (to - from) - 2.0 * m0 - m1, c3 = 2.0 * (from - to) + m0 + m1;
  point.known = true;
  point.force_N = from + u * (m0 + u * (c2 + u * c3));
  point.slope_N_per_s = (m0 + u * (2.0 * c2 + 3.0 * u * c3)) / h;
  return point;
}

DelayComparison::DelayComparison(std::span<const TimedForce> tracker, std::span<const TimedForce> sensor,
                                 const DelayOptions& options)
    : curve_(sensor), options_(options) {
  for (const TimedForce& sample : tracker)
    if (sample.time_s - options.max_delay_s >= sensor.front().time_s &&
        sample.time_s + options.max_delay_s <= sensor.back().time_s)
      tracker_.push_back(sample);
  if (tracker_.size() < kFewest) refuse_overlap(tracker, sensor, tracker_.size(), options.max_delay_s);
}

double DelayComparison::scan_step_s() const {
  return std::max(options_.max_delay_s / 2000.0,
                  std::min({0.5 * curve_.step_s(), 0.5 * median_step(tracker_), options_.max_delay_s / 20.0}));
}

Overlay DelayComparison::overlay(double delay_s) const {
  Overlay o;
  Vector3d W = Vector3d::Zero(), wF = W, wT = W, wFF = W, wFT = W, wTT = W;
  for (const TimedForce& sample : tracker_) {
    const ForceCurve::Point sensor = curve_.at(sample.time_s - delay_s);
    if (!sensor.known) continue;
    const Vector3d w = sample.sigma_N.cwiseAbs2().cwiseInverse(), &F = sample.force_N, &T = sensor.force_N;
    W += w;
    wF += w.cwiseProduct(F);
    wT += w.cwiseProduct(T);
    wFF += w.cwiseProduct(F.cwiseAbs2());
    wFT += w.cwiseProduct(F.cwiseProduct(T));
    wTT += w.cwiseProduct(T.cwiseAbs2());
    ++o.used;
  }
  if (o.used < kFewest) {  // the rest fell into gaps: a handful of samples fits any trace
    o.cost = std::numeric_limits<double>::infinity();
    return o;
  }
  const double numbers = 3.0 * static_cast<double>(o.used);
  const double FF = (wFF - wF.cwiseAbs2().cwiseQuotient(W)).sum(), TT = (wTT - wT.cwiseAbs2().cwiseQuotient(W)).sum();
  const double FT = (wFT - wF.cwiseProduct(wT).cwiseQuotient(W)).sum();
  // A force that pulls where the other pushes is none: a rhythm shifted by half a period would else fit as well.
  o.gain = !options_.free_gain ? 1.0 : TT > 0.0 ? std::max(0.0, FT / TT) : 0.0;
  o.offset_N = (wF - o.gain * wT).cwiseQuotient(W);
  o.cost = std::max(0.0, FF - 2.0 * o.gain * FT + o.gain * o.gain * TT) / numbers;
  o.unexplained = FF / numbers;
  o.sensor_power = TT / numbers;
  return o;
}

void DelayComparison::finish(DelayFit& fit) const {
  const Overlay best = overlay(fit.delay_s);
  fit.gain = best.gain;
  fit.offset_N = best.offset_N;
  fit.explained = best.explained();
  fit.used = best.used;
  Matrix5d A = Matrix5d::Zero();
  std::vector<Vector5d> scores;
  double squares = 0.0;
  for (const TimedForce& sample : tracker_) {
    const ForceCurve::Point sensor = curve_.at(sample.time_s - fit.delay_s);
    if (!sensor.known) continue;
    fit.times_s.push_back(sample.time_s);
    fit.sensor_N.emplace_back(fit.gain * sensor.force_N + fit.offset_N);
    const Vector3d residual = sample.force_N - fit.sensor_N.back();
    squares += residual.squaredNorm();
    Eigen::Matrix<double, 3, 5> J;  // of the prediction by d, g, b
    J << -fit.gain * sensor.slope_N_per_s, options_.free_gain ? sensor.force_N : Vector3d::Zero().eval(),
        Matrix3d::Identity();
    const Eigen::Matrix<double, 5, 3> JW = J.transpose() * sample.sigma_N.cwiseAbs2().cwiseInverse().asDiagonal();
    A += JW * J;
    scores.emplace_back(JW * residual);
  }
  if (!options_.free_gain) A(1, 1) = 1.0;
  fit.rms_N = std::sqrt(squares / (3.0 * static_cast<double>(fit.used)));
  set_sigmas(A, scores, fit);
}

void DelayComparison::set_sigmas(const Matrix5d& A, const std::vector<Vector5d>& scores, DelayFit& fit) const {
  std::vector<double> along_delay;
  along_delay.reserve(scores.size());
  for (const Vector5d& score : scores) along_delay.push_back(score(0));
  const double apart = samples_per_independent(along_delay);
  const Eigen::LDLT<Matrix5d> solver(A);
  const Matrix5d half = solver.solve(long_run_covariance(scores, static_cast<std::size_t>(3.0 * apart)));
  const Matrix5d covariance = solver.solve(half.transpose());
  fit.correlation_time_s = apart * median_step(tracker_);
  fit.sigma_s = std::sqrt(covariance(0, 0));
  fit.gain_sigma = options_.free_gain ? std::sqrt(covariance(1, 1)) : 0.0;
}

}  // namespace palpate
