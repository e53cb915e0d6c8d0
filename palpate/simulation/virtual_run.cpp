// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/simulation/equilibrium_path.hpp>
#include <palpate/simulation/error_tracker.hpp>
#include <palpate/simulation/virtual_run.hpp>

namespace palpate {

namespace {

/// The scenario on its way: one frame after the other into the run.
class Player {
 public:
  Player(const Scenario& scenario, const RunOptions& options)
      : scenario_(scenario),
        options_(options),
        source_(scenario),
        path_(scenario.catheter, scenario.load),
        tracker_(scenario.catheter, scenario.tracker, scenario.seed),
        tendon_engine_(random_engine(scenario.seed, RandomStream::kTendon)) {}

  void play(std::int64_t number) {
    const double time_s = static_cast<double>(number) / scenario_.tracker.rate_hz;
    const SituationSource::Now now = source_.at(time_s);
    if (number == 0) begin(now.situation);
    tell_snaps(path_.follow(now.situation), number);
    const bool touches = path_.balance().contact.touches;
    if (number > 0 && touches != touched_)
      run_.events.push_back({.time_s = time_s, .what = touches ? "contact made" : "contact lost"});
    touched_ = touches;
    record(number, time_s, now);
  }

  VirtualRun take() { return std::move(run_); }

 private:
  void begin(const Situation& situation);
  void tell_snaps(const std::vector<Snap>& snaps, std::int64_t number);
  void record(std::int64_t number, double time_s, const SituationSource::Now& now);
  TendonReading read_tendon(const SituationSource::Now& now);
  Truth truth_at(double time_s, const Situation& situation) const;

  const Scenario& scenario_;
  RunOptions options_;
  SituationSource source_;
  EquilibriumPath path_;
  ErrorTracker tracker_;
  std::mt19937_64 tendon_engine_;
  std::normal_distribution<double> normal_;
  bool touched_ = false;
  VirtualRun run_;
};

void Player::begin(const Situation& situation) {
  path_.rest(situation);
  const auto* wall = std::get_if<WallLoad>(&scenario_.load);
  if (wall == nullptr) return;
  const Vector3d& place = path_.balance().place_room_m;
  const double depth_m = wall_depth_m(*wall, situation, place);
  if (depth_m > 1e-9)
    throw InputError(
        fmt::format("load.point_base_m: at the start the wall reaches {:.6g} m beyond the catheter's contact point at "
                    "[{:.6g}, {:.6g}, {:.6g}] m (base frame): expected a wall that starts clear of it",
                    depth_m, place.x(), place.y(), place.z()));
}

void Player::tell_snaps(const std::vector<Snap>& snaps, std::int64_t number) {
  for (const Snap& snap : snaps) {
    // The way to the first frame is the load's growth from nothing, all at time zero.
    const double frames = number == 0 ? 0.0 : static_cast<double>(number - 1) + snap.share;
    const double time_s = frames / scenario_.tracker.rate_hz;
    const std::string place = fmt::format("at {:.4g} s, {:.4g} N", time_s, snap.force_N);
    if (!snap.settled)
      throw InputError(
          fmt::format("load: {}: no stable equilibrium was found: expected less force, a softer wall or less "
                      "friction",
                      place));
    const std::string lost = fmt::format("{}: the branch of equilibria followed from rest loses its stability", place);
    if (options_.stable_only) throw InputError(fmt::format("load: {}: expected a stable load path", lost));
    run_.events.push_back(
        {.time_s = time_s,
         .what = fmt::format("{}; the catheter snaps to another shape (contact point moved by {:.3g} mm, tip turned by "
                             "{:.3g} deg), and that branch is kept",
                             lost, snap.tip_moved_m * kMillimetresPerMetre, snap.tip_turned_rad / kRadiansPerDegree),
         .instability = true});
  }
}

TendonReading Player::read_tendon(const SituationSource::Now& now) {
  if (!now.moment_1_Nm) return {};
  const double sigma_Nm = scenario_.handle.moment_sigma_fraction * std::abs(*now.moment_1_Nm);
  const double noise_Nm = sigma_Nm * normal_(tendon_engine_);
  return {.present = true, .moment_Nm = {*now.moment_1_Nm + noise_Nm, 0.0}, .sigma_Nm = sigma_Nm};
}

Truth Player::truth_at(double time_s, const Situation& situation) const {
  const Catheter& catheter = scenario_.catheter;
  const Balance& balance = path_.balance();
  const Pose T_room_base = situation.T_room_base();
  const auto* const wall = std::get_if<WallLoad>(&scenario_.load);
  return {
      .time_s = time_s,
      .force_tip_N = balance.contact_tip_N,
      .force_base_N = T_room_base.R.transpose() * balance.contact.force_room_N,
      .stiffness_Nm2 = catheter.rod.first_flexible().stiffness_Nm2.cwiseQuotient(compliance_factor(situation.shaft)),
      .precurvature_per_m = catheter.precurvature_per_m() + situation.shaft.precurvature_per_m,
      .T_tracker_base = catheter.base.T_tracker_base * T_room_base,
      .T_base_tip = T_room_base.inverse() * balance.T_room_tip,
      .in_contact = balance.contact.touches,
      .wall_base_m = wall == nullptr ? Vector3d(Vector3d::Constant(Truth::kNoWall))
                                     : T_room_base.inverse() * wall_point_room_m(*wall, situation)};
}

void Player::record(std::int64_t number, double time_s, const SituationSource::Now& now) {
  const Truth truth = truth_at(time_s, now.situation);
  std::vector<Pose> T_base_local;
  for (std::size_t i = 0; i < scenario_.catheter.sensors.size(); ++i)
    T_base_local.push_back(path_.shape().points[i].T_base_local);
  TrackerFrame frame{.time_s = tracker_.stamp(time_s),
                     .number = number,
                     .readings = tracker_.read(T_base_local, truth.T_tracker_base),
                     .tendon = read_tendon(now)};
  if (tracker_.drops_frame()) return;  // all was drawn: the frames that come are as they would be
  run_.frames.push_back(std::move(frame));
  run_.truth.push_back(truth);
  if (now.knob_rad) run_.knob_rad.push_back(*now.knob_rad);
}

}  // namespace

VirtualRun run_scenario(const Scenario& scenario, const RunOptions& options) {
  scenario.validate();
  Player player(scenario, options);
  const auto frames = static_cast<std::int64_t>(std::llround(scenario.duration_s * scenario.tracker.rate_hz));
  for (std::int64_t number = 0; number < frames; ++number) {
    player.play(number);
    if (options.progress) options.progress(static_cast<double>(number + 1) / static_cast<double>(frames));
  }
  return player.take();
}

}  // namespace palpate
