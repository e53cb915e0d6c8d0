// SPDX-License-Identifier: Apache-2.0
#include "identify_noise_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/math/units.hpp>

namespace palpate::app {

namespace {

constexpr double kDegrees = 1.0 / kRadiansPerDegree;

std::string triple(const Vector3d& v, double scale) {
  return fmt::format("{:.4f} {:.4f} {:.4f}", scale * v.x(), scale * v.y(), scale * v.z());
}

/// Roots of the six variances.
void print_sigmas(const SensorNoise& sensor, bool has_orientation) {
  fmt::print("  position sigma     {} mm along the tracker's axes\n",
             triple(sensor.position_m2().diagonal().cwiseSqrt(), kMillimetresPerMetre));
  if (has_orientation)
    fmt::print("  orientation sigma  {} deg about the sensor's axes\n",
               triple(sensor.rotation_rad2().cwiseSqrt(), kDegrees));
}

template <class Noise>
void print_counts(const Noise& noise) {
  std::string lost;
  for (const auto& [count, what] : {std::pair{noise.missing, "missing"},
                                    {noise.unusable, "no pose"},
                                    {noise.bad_times, "not later than the one before"}})
    if (count > 0) lost += fmt::format(", {} {}", count, what);
  fmt::print("  readings           {} used of {} frames{}; dropouts {:.1f} %\n", noise.used, noise.frames, lost,
             noise.frames > 0
                 ? 100.0 * static_cast<double>(noise.missing + noise.unusable) / static_cast<double>(noise.frames)
                 : 0.0);
  const SensorTiming& t = noise.timing;
  fmt::print("  rate               {:.2f} /s over {:.2f} s, period {:.4f} s, jitter {:.4f} s, longest gap {:.3f} s\n",
             t.mean_rate_Hz, t.duration_s, t.period_s, t.jitter_s, t.longest_gap_s);
}

const char* in_words(Rest rest) {
  switch (rest) {
    case Rest::kStill:
      return "stands still";
    case Rest::kDrifts:
      return "stands still but for a slow part: drift, or a filter in the device";
    case Rest::kMoves:
      return "MOVES: what is given as noise is motion";
  }
  return "";
}

void print_rest(const SensorNoise& sensor) {
  const RestNoise& n = *sensor.rest;
  print_counts(n);
  print_sigmas(sensor, n.has_orientation);
  fmt::print("  worst direction    {:.4f} mm", n.worst_position_sigma_m() * kMillimetresPerMetre);
  if (n.has_orientation) fmt::print(", {:.4f} deg", n.worst_rotation_sigma_rad() * kDegrees);
  fmt::print("\n  fast, slow part    {:.4f}, {:.4f} mm", n.white_m * kMillimetresPerMetre,
             n.slow_m * kMillimetresPerMetre);
  if (n.has_orientation) fmt::print("; {:.4f}, {:.4f} deg", n.white_rad * kDegrees, n.slow_rad * kDegrees);
  // A step far below the noise is no quantisation but chance.
  const auto step = [](double value, double sigma, double scale, const char* unit) {
    return value > 0.01 * sigma ? fmt::format("{:.3g} {}", scale * value, unit) : std::string("none seen");
  };
  fmt::print(" (rms of the axes)\n  quantisation       {}",
             step(n.step.head<3>().maxCoeff(), n.worst_position_sigma_m(), kMillimetresPerMetre, "mm"));
  if (n.has_orientation) fmt::print(", {}", step(n.step(3), n.worst_rotation_sigma_rad(), kDegrees, "deg"));
  fmt::print("\n");
  fmt::print("  independent        {:.0f} of them, one in {:.3f} s; {} repeat the one before; {} outliers left out\n",
             n.effective_samples, n.correlation_time_s, n.used - n.distinct, n.outliers);
  fmt::print("  known to           +- {:.1f} % of a sigma\n", 100.0 * n.sigma_fraction);
  fmt::print("  at rest            {}\n", in_words(n.rest));
}

void print_moving(const SensorNoise& sensor) {
  const MovingNoise& n = *sensor.moving;
  print_counts(n);
  if (n.repeated > 0) fmt::print("  repetitions        {} passed over\n", n.repeated);
  print_sigmas(sensor, n.has_orientation);
  fmt::print("  known to           +- {:.1f} % of a sigma\n", 100.0 * sensor.sigma_fraction());
  fmt::print("  channel   model of motion          beyond 95 %  correlation (white)  outliers  holds\n");
  constexpr std::array kNames{"x", "y", "z", "turn x", "turn y", "turn z"};
  for (std::size_t k = 0; k < (n.has_orientation ? 6u : 3u); ++k) {
    const MovingChannel& c = n.channels[k];
    fmt::print("  {:<8}  {:<22} {:>11.1f} %  {:>11.3f} ({:.3f})  {:>8}  {}\n", kNames[k],
               c.order == 2 ? "constant velocity" : "constant acceleration", 100.0 * c.outside_95, c.correlation,
               c.correlation_if_white, c.outliers, c.holds() ? "yes" : "NO");
  }
}

void warn_of_bias(const SensorNoise& s, std::vector<std::string>& warnings) {
  if (s.sensor == nullptr) return;
  const bool turns = s.sensor->kind != SensorKind::kPosition;
  if (s.sensor->bias_m > 0.0 && (s.sensor->bias_rad > 0.0 || !turns)) return;
  warnings.push_back(fmt::format(
      "sensor \"{}\": the catheter file states no accuracy error ({} = 0), and a recording of noise cannot "
      "show it: put in what the tracker's maker states (an Aurora: 0.48 mm, 0.3 deg), or every sigma of the "
      "force is too small",
      s.name,
      s.sensor->bias_m > 0.0 ? "bias_deg"
      : turns                ? "bias_mm, bias_deg"
                             : "bias_mm"));
}

void warn_of_rest(const SensorNoise& s, std::vector<std::string>& warnings) {
  const RestNoise& n = *s.rest;
  if (n.rest == Rest::kMoves)
    warnings.push_back(fmt::format(
        "sensor \"{}\" does not rest: {:.3g} mm and {:.3g} deg of scatter, of which {:.3g} mm and {:.3g} deg "
        "from reading to reading: choose a part at rest with --interval, or use --moving",
        s.name, std::hypot(n.white_m, n.slow_m) * kMillimetresPerMetre, std::hypot(n.white_rad, n.slow_rad) * kDegrees,
        n.white_m * kMillimetresPerMetre, n.white_rad * kDegrees));
  const double a_piece = static_cast<double>(n.used) / n.effective_samples;
  if (n.rest != Rest::kMoves && a_piece > 1.5)
    warnings.push_back(fmt::format(
        "sensor \"{}\": only one reading in {:.1f} is news (repeated rows, drift, or a filter in the device): "
        "a filter that takes each as new believes its mean {:.1f} times too much",
        s.name, a_piece, std::sqrt(a_piece)));
}

}  // namespace

Matrix3d SensorNoise::position_m2() const {
  if (rest) return rest->covariance.topLeftCorner<3, 3>();
  Vector3d variance;
  for (int k = 0; k < 3; ++k) variance(k) = std::pow(moving->channels[static_cast<std::size_t>(k)].sigma, 2);
  return variance.asDiagonal();
}

Vector3d SensorNoise::rotation_rad2() const {
  if (rest) return rest->covariance.diagonal().tail<3>();
  Vector3d variance;
  for (int k = 0; k < 3; ++k) variance(k) = std::pow(moving->channels[static_cast<std::size_t>(k) + 3].sigma, 2);
  return variance;
}

double SensorNoise::sigma_fraction() const {
  if (rest) return rest->sigma_fraction;
  double largest = 0.0;
  for (std::size_t k = 0; k < (moving->has_orientation ? 6u : 3u); ++k)
    largest = std::max(largest, moving->channels[k].sigma_fraction);
  return largest;
}

std::vector<std::string> warnings_of(const NoiseReport& report) {
  std::vector<std::string> warnings;
  for (const SensorNoise& s : report.sensors) {
    if (!s.untold().empty()) {
      warnings.push_back(fmt::format("sensor \"{}\": its noise cannot be told: {}", s.name, s.untold()));
      continue;
    }
    if (s.rest) warn_of_rest(s, warnings);
    if (s.moving && !s.moving->holds())
      warnings.push_back(fmt::format(
          "sensor \"{}\": the motion is too quick or too uneven for this rate: what is found may be motion, "
          "and goes into no catheter file; move it more slowly and smoothly",
          s.name));
    warn_of_bias(s, warnings);
  }
  return warnings;
}

void NoiseReport::print() const {
  fmt::print("{}: noise of {} sensors, {}\n", source, sensors.size(), moving ? "moving" : "at rest");
  for (const SensorNoise& s : sensors) {
    fmt::print("sensor \"{}\"{}\n", s.name, s.sensor != nullptr ? ", on the catheter" : "");
    if (!s.untold().empty())
      fmt::print("  cannot be told: {}\n", s.untold());
    else if (s.rest)
      print_rest(s);
    else
      print_moving(s);
  }
  fmt::print(
      "This is precision: how far readings scatter about their own mean. Accuracy, how far that mean is from the "
      "truth,\n"
      "does not show here: it varies slowly over space and is mostly the larger (an Aurora states 0.48 mm and 0.3 "
      "deg).\n"
      "It stays what bias_mm and bias_deg of the catheter file say.\n");
  if (!out.empty()) fmt::print("written: {}\n", out);
}

}  // namespace palpate::app
