// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <palpate/math/units.hpp>
#include <palpate/service/host_clock.hpp>
#include <palpate/service/page_row.hpp>

namespace palpate::service {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMillisecondsPerNanosecond = 1e-6;

double milliseconds(std::int64_t ns) { return kMillisecondsPerNanosecond * static_cast<double>(ns); }
double number_of(bool flag) { return flag ? 1.0 : 0.0; }

}  // namespace

PageRowMaker::PageRowMaker(const Catheter& catheter, const PlayedTruth* truth)
    : truth_(truth), shape_(catheter, static_cast<int>(kPagePoints)) {}

void PageRowMaker::set_catheter(const Catheter& catheter) {
  shape_ = ShownShape(catheter, static_cast<int>(kPagePoints));
}

const PageRow& PageRowMaker::row(const CatheterView& view, const LiveFigures& figures, std::int64_t now_ns) {
  row_.fill(kNaN);
  put_now(view, now_ns);
  put_course(figures);
  put(page_place("contact"), number_of(figures.in_contact() && shows_force(view, now_ns)));
  put_truth(view);
  if (!shows_force(view, now_ns)) return row_;
  put_force(figures, view.latest.estimate);
  put_shape(view);
  return row_;
}

void PageRowMaker::put_now(const CatheterView& view, std::int64_t now_ns) {
  const Estimate& estimate = view.latest.estimate;
  put(page_place("time_s"), view.latest.output_time_s);
  put(page_place("received_ms"), milliseconds(view.latest.received_ns - nanoseconds(view.latest.late_s)));
  put(page_place("sent_ms"), milliseconds(now_ns));
  put(page_place("state"), static_cast<double>(state_of(view, now_ns)));
  put(page_place("status"), static_cast<double>(estimate.status));
  put(page_place("shown"), number_of(shows_force(view, now_ns)));
  put(page_place("stale_after_s"),
      kSecondsPerNanosecond * static_cast<double>(view.live->counters().stale_after_ns.get()));
  put(page_place("axial_hidden"), number_of(estimate.observability.axial_force_hidden));
  put(page_place("lateral_hidden"), number_of(estimate.observability.lateral_force_hidden));
  put(page_place("stiffness_on_prior"), number_of(estimate.observability.stiffness_rests_on_prior));
  put(page_place("stiffness_Nm2"), estimate.shaft.stiffness_Nm2);
  put(page_place("sigma_stiffness_Nm2"), estimate.shaft.stiffness_sigma_Nm2);
}

void PageRowMaker::put_force(const LiveFigures& figures, const Estimate& estimate) {
  const ForceParts& parts = figures.latest();
  put(page_place("size_N"), parts.size_N);
  put(page_place("sigma_size_N"), parts.sigma_size_N);
  put(page_place("axial_N"), parts.axial_N);
  put(page_place("sigma_axial_N"), parts.sigma_axial_N);
  put(page_place("lateral_N"), parts.lateral_N);
  put(page_place("sigma_lateral_N"), parts.sigma_lateral_N);
  put(page_place("angle_rad"), parts.angle_rad);
  put(page_place("sigma_angle_rad"), parts.sigma_angle_rad);
  put(page_place("force_tip_N"), estimate.force_tip_N);
  put(page_place("sigma_tip_N"), estimate.covariance_tip_N2.diagonal().cwiseSqrt());
  put(page_place("force_base_N"), estimate.force_base_N);
  put(page_place("nis"), estimate.dof > 0 ? estimate.nis : kNaN);
  put(page_place("dof"), estimate.dof);
}

void PageRowMaker::put_course(const LiveFigures& figures) {
  const Contact& contact = figures.contact();
  if (figures.in_contact()) put(page_place("contact_s"), contact.duration_s());
  if (contact.frames > 0) {
    put(page_place("contact_integral_Ns"), contact.integral_Ns);
    put(page_place("contact_integral_sigma_Ns"), contact.integral_sigma_Ns);
    put(page_place("contact_largest_N"), contact.largest_N);
  }
  const ForceIntegral& integral = figures.integral();
  put(page_place("integral_Ns"), integral.integral_Ns);
  put(page_place("integral_sigma_Ns"), integral.sigma_Ns);
  put(page_place("measured_s"), integral.measured_s);
  put(page_place("unmeasured_s"), integral.unmeasured_s);
  if (!figures.beat()) return;
  put(page_place("beats_per_min"), figures.beat()->per_min);
  put(page_place("beat_strength"), figures.beat()->strength);
}

void PageRowMaker::put_shape(const CatheterView& view) {
  const Estimate& estimate = view.latest.estimate;
  const RodSolution<3>& solution = shape_.solve(view.latest.frame, row_of(estimate));
  const Pose& tip = solution.T_base_tip;
  const ForceEllipsoid region = force_ellipsoid(estimate.covariance_tip_N2);
  put(page_place("ellipsoid_base_N"), Matrix3d(tip.R * region.axes * region.semi_axes_N.asDiagonal()));
  put(page_place("R_base_tip"), tip.R);
  put(page_place("contact_mm"), Vector3d(kMillimetresPerMetre * (tip * view.catheter.rod.contact_offset_m)));
  std::size_t shaft = page_place("shaft_mm"), sensors = page_place("sensors_mm");
  for (std::size_t i = 0; i < solution.points.size(); ++i) {
    std::size_t& place = i < kPagePoints ? shaft : sensors;
    put(place, Vector3d(kMillimetresPerMetre * solution.points[i].T_base_local.p));
    place += 3;
  }
  register_frame(view.catheter, view.latest.frame, measurement_);
  for (int i = 0; i < measurement_.count; ++i) {
    const auto& seen = measurement_.poses[static_cast<std::size_t>(i)];
    put(page_place("seen_mm") + 3 * static_cast<std::size_t>(seen.sensor),
        Vector3d(kMillimetresPerMetre * seen.T_base_sensor.p));
  }
}

const PlayedTruth::Moment* PageRowMaker::truth_at(const CatheterView& view) const {
  const bool frame = view.latest.kind == session::LiveRecord::Kind::kFrame;
  return truth_ != nullptr && frame ? truth_->at(view.latest.frame.number) : nullptr;
}

void PageRowMaker::put_truth(const CatheterView& view) {
  const PlayedTruth::Moment* const moment = truth_at(view);
  if (moment == nullptr) return;
  put(page_place("truth_tip_N"), moment->force_tip_N);
  put(page_place("truth_size_N"), moment->force_tip_N.norm());
  put(page_place("wall_mm"), Vector3d(kMillimetresPerMetre * moment->wall_base_m));
}

PageHistory::Row PageRowMaker::history_row(const CatheterView& view, const LiveFigures& figures,
                                           std::int64_t now_ns) const {
  const ForceParts parts = shows_force(view, now_ns) ? figures.latest() : ForceParts();
  const PlayedTruth::Moment* const moment = truth_at(view);
  // In the order of kPageHistory.
  return {view.latest.output_time_s,
          static_cast<double>(state_of(view, now_ns)),
          static_cast<double>(view.latest.estimate.status),
          parts.size_N,
          parts.sigma_size_N,
          parts.axial_N,
          parts.sigma_axial_N,
          parts.lateral_N,
          parts.sigma_lateral_N,
          number_of(figures.in_contact()),
          figures.integral().integral_Ns,
          moment != nullptr ? moment->force_tip_N.norm() : kNaN};
}

}  // namespace palpate::service
