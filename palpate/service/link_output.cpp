// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <palpate/link/codec.hpp>
#include <palpate/math/units.hpp>
#include <palpate/sensing/measurement.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/link_output.hpp>

namespace palpate::service {

namespace {

constexpr int kPoints = 41;  // along the shaft

link::Matrix matrix_of(const Pose& pose) {
  link::Matrix out;
  for (int i = 0; i < 9; ++i) out.columns[static_cast<std::size_t>(i)] = static_cast<float>(pose.R(i % 3, i / 3));
  for (int i = 0; i < 3; ++i)
    out.columns[9 + static_cast<std::size_t>(i)] = static_cast<float>(kMillimetresPerMetre * pose.p(i));
  return out;
}

double finite_or_nan(double value) { return std::isfinite(value) ? value : std::numeric_limits<double>::quiet_NaN(); }

link::Sensor force_of(const Vector3d& force_N, const Matrix3d& covariance_N2, bool live) {
  link::Sensor out{.unit = link::kNewton};
  for (int i = 0; i < 3; ++i)
    out.values.push_back(live ? finite_or_nan(force_N(i)) : std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 3; ++i) out.values.push_back(finite_or_nan(std::sqrt(covariance_N2(i, i))));
  return out;
}

/// The clamp in the tracker's frame; none where its own sensor was not seen.
std::optional<Pose> T_tracker_base(const CatheterView& view) {
  const BaseRegistration& base = view.catheter.base;
  if (!base.tracked) return base.T_tracker_base;
  const SensorReading& reading = view.latest.frame.readings.back();
  if (screen(reading, base.sensor.kind) != Rejection::kNone) return std::nullopt;
  return reading_pose(reading) * base.sensor.T_local_sensor.inverse();
}

}  // namespace

LinkOutput::LinkOutput(const CatheterSettings& settings, const LinkSettings& rates)
    : name_(settings.name),
      shape_every_ns_(nanoseconds(1.0 / rates.shape_hz)),
      health_every_ns_(nanoseconds(1.0 / rates.health_hz)),
      shape_(settings.settings.catheter, kPoints) {}

void LinkOutput::set_catheter(const Catheter& catheter) { shape_ = ShownShape(catheter, kPoints); }

void LinkOutput::add(const CatheterView& view, std::int64_t now_ns, std::vector<std::byte>& out) {
  const Estimate& estimate = view.latest.estimate;
  const bool live = shows_force(view, now_ns);
  const Matrix3d& R = estimate.R_base_tip;
  const double time_s = view.latest.output_time_s;
  link::encode({.device = name_ + "Force",
                .time_s = time_s,
                .body = force_of(estimate.force_tip_N, estimate.covariance_tip_N2, live)},
               out);
  link::encode({.device = name_ + "ForceBase",
                .time_s = time_s,
                .body = force_of(estimate.force_base_N, R * estimate.covariance_tip_N2 * R.transpose(), live)},
               out);
  if (!live || now_ns < shape_due_ns_) return;
  shape_due_ns_ = now_ns + shape_every_ns_;
  add_shape(view, out);
}

void LinkOutput::add_shape(const CatheterView& view, std::vector<std::byte>& out) {
  const std::optional<Pose> base = T_tracker_base(view);
  if (!base) return;
  const RodSolution<3>& solution = shape_.solve(view.latest.frame, row_of(view.latest.estimate));
  link::PolyData line;
  std::vector<std::uint32_t> indices;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d p_mm = kMillimetresPerMetre * (*base * solution.points[static_cast<std::size_t>(i)].T_base_local.p);
    line.points_mm.push_back(
        {static_cast<float>(p_mm.x()), static_cast<float>(p_mm.y()), static_cast<float>(p_mm.z())});
    indices.push_back(static_cast<std::uint32_t>(i));
  }
  line.lines.push_back(std::move(indices));
  const double time_s = view.latest.output_time_s;
  const auto send = [&](const char* what, link::Body body) {
    link::encode({.device = name_ + what, .time_s = time_s, .body = std::move(body)}, out);
  };
  send("Tip", link::Transform{matrix_of(*base * solution.T_base_tip)});
  send("Base", link::Transform{matrix_of(*base)});
  send("Shape", std::move(line));
}

void LinkOutput::add_health(const CatheterView& view, std::int64_t now_ns, std::vector<std::byte>& out) {
  const LiveState state = health_of(view, now_ns).state;
  if (now_ns < health_due_ns_ && state == said_) return;
  said_ = state;
  health_due_ns_ = now_ns + health_every_ns_;
  link::encode({.device = name_ + "Health",
                .time_s = view.any ? view.latest.output_time_s : kSecondsPerNanosecond * static_cast<double>(now_ns),
                .body = link::String{text_of(catheter_json(view, now_ns))}},
               out);
}

}  // namespace palpate::service
