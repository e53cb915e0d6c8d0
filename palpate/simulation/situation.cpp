// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/simulation/situation.hpp>

namespace palpate {

Pose Situation::T_room_base() const { return {exp_so3({0.0, 0.0, twist_rad}), {0.0, 0.0, translation_m}}; }

Situation between(const Situation& from, const Situation& to, double share) {
  const auto mix = [share](const auto& a, const auto& b) { return a + share * (b - a); };
  const auto mix3 = [share](const Vector3d& a, const Vector3d& b) -> Vector3d { return a + share * (b - a); };
  Situation s;
  s.shaft.moment_tip_Nm = mix3(from.shaft.moment_tip_Nm, to.shaft.moment_tip_Nm);
  s.shaft.tendon_couple_Nm = mix3(from.shaft.tendon_couple_Nm, to.shaft.tendon_couple_Nm);
  s.shaft.log_stiffness = mix3(from.shaft.log_stiffness, to.shaft.log_stiffness);
  s.shaft.precurvature_per_m = mix3(from.shaft.precurvature_per_m, to.shaft.precurvature_per_m);
  s.twist_rad = mix(from.twist_rad, to.twist_rad);
  s.translation_m = mix(from.translation_m, to.translation_m);
  s.flow_tip_N = mix3(from.flow_tip_N, to.flow_tip_N);
  s.force_N = mix3(from.force_N, to.force_N);
  s.pulley_m = mix3(from.pulley_m, to.pulley_m);
  s.wall_m = mix(from.wall_m, to.wall_m);
  s.load_share = mix(from.load_share, to.load_share);
  return s;
}

bool has_knob(const HandleMotion& handle) {
  const Signal& knob = handle.knob_rad;
  return knob.constant != 0.0 || !knob.sines.empty() || !knob.points.empty();
}

SituationSource::SituationSource(const Scenario& scenario) : scenario_(scenario), flow_(scenario.flow, scenario.seed) {
  if (const auto* wall = std::get_if<WallLoad>(&scenario.load)) heart_.emplace(wall->heart, scenario.seed);
  if (has_knob(scenario.handle))
    play_.emplace(scenario.catheter.tendon_map, scenario.catheter.precurvature_per_m().head<2>());
}

void SituationSource::move_handle(double time_s, Now& now) {
  const HandleMotion& handle = scenario_.handle;
  TipLoad& shaft = now.situation.shaft;
  shaft.precurvature_per_m.x() = handle.bend_1_per_m.at(time_s);
  if (play_) {
    now.knob_rad = handle.knob_rad.at(time_s);
    shaft.precurvature_per_m.head<2>() += play_->advance(*now.knob_rad, play_memory_).change_per_m;
  }
  if (handle.tendon) {
    now.moment_1_Nm = handle.moment_1_Nm.at(time_s);
    const bool couple = scenario_.catheter.tendon.model == TendonModel::kCouple;
    (couple ? shaft.tendon_couple_Nm : shaft.moment_tip_Nm).x() = *now.moment_1_Nm;
  }
  now.situation.twist_rad = handle.twist_rad.at(time_s);
  now.situation.translation_m = handle.translation_m.at(time_s);
}

SituationSource::Now SituationSource::at(double time_s) {
  Now now;
  move_handle(time_s, now);
  Situation& situation = now.situation;
  const double factor = scenario_.stiffness_factor.at(time_s);
  if (!(factor >= 1e-3 && factor <= 1e3))
    throw InputError(fmt::format("stiffness_factor = {} at {:.6g} s: expected 0.001 to 1000", factor, time_s));
  if (factor != 1.0) situation.shaft.log_stiffness.setConstant(std::log(factor));
  situation.flow_tip_N = flow_.next(time_s - last_s_);
  last_s_ = time_s;
  if (const auto* force = std::get_if<ForceLoad>(&scenario_.load))
    situation.force_N = palpate::at(force->force_N, time_s);
  if (const auto* pulley = std::get_if<PulleyLoad>(&scenario_.load))
    situation.pulley_m = palpate::at(pulley->pulley_base_m, time_s);
  if (const auto* wall = std::get_if<WallLoad>(&scenario_.load))
    situation.wall_m = wall->along_normal_m.at(time_s) + heart_->at(time_s);
  return now;
}

}  // namespace palpate
