// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <palpate/sensing/tracker_frame.hpp>
#include <vector>

/// How the handle bends the unloaded shaft, friction and slack included.
namespace palpate {

/// What tells where the handle stands.
enum class TendonInput : std::uint8_t {
  kKnob,          ///< angle of the knob [rad]
  kDisplacement,  ///< of the tendon [m]
  kTension,       ///< of the tendon [N]
};

/// Precurvature k1,0, k2,0 of the unloaded shaft against the position of the handle, measured on a loop over the whole
/// range: `pull` while the position rises, `release` while it falls. Both are monotone in k1,0, and the release branch
/// is the more bent one: friction holds what was pulled.
struct TendonMap {
  static constexpr std::size_t kMostPositions = 64;

  bool present = false;
  TendonInput input = TendonInput::kKnob;
  std::vector<double> position;                ///< rad, m or N; strictly rising
  std::vector<Eigen::Vector2d> pull_per_m;     ///< (k1,0, k2,0) at the positions
  std::vector<Eigen::Vector2d> release_per_m;  ///< likewise
  Eigen::Vector2d sigma_per_m{0.0, 0.0};       ///< one standard deviation of what the map says

  /// Throws InputError naming the entry, its value and what was expected.
  void validate() const;
};

/// A TendonMap made ready for use while the handle moves. Between the branches stands a generalised play operator:
///
///   z_k = max(pull(u_k), min(release(u_k), z_(k-1)))
///
/// the curvature z keeps its value while the position u crosses the dead zone, then follows the other branch. Both
/// branches are monotone cubic curves through the map's entries (slopes by parabolas through three entries, limited
/// after Fritsch and Carlson 1980). k2,0 stands between its branches as k1,0 between its own.
///
/// Where the history is not known, as before the first movement, z is anywhere between two bounds; both pass through
/// the operator and meet as soon as the dead zone was crossed once. Play operator: Krasnosel'skii and Pokrovskii 1989;
/// generalised by its envelopes: Visintin 1994, chapter III.
class TendonPlay {
 public:
  /// `precurvature_per_m`: (k1,0, k2,0) of the catheter file, from which BendReading counts. Precondition: a valid map.
  TendonPlay(const TendonMap& map, const Eigen::Vector2d& precurvature_per_m);

  /// What the past has left: bounds of z, in the sense in which it rises.
  struct Memory {
    bool started = false;
    double least_per_m = 0.0, most_per_m = 0.0;
  };

  /// The handle has moved, without turning on the way, to `position`. sigma^2 = sigma_map^2 + (distance of the
  /// bounds)^2 / 12; outside the map it is held at the end, and sigma grows by the slope times the distance. A position
  /// that is no number changes nothing; the reading then is not present. Neither allocates nor throws; about 0.1 us.
  BendReading advance(double position, Memory& memory) const;

  /// (k1,0, k2,0) of one branch; the end's outside the map.
  Eigen::Vector2d pull_per_m(double position) const { return value(pull_, position); }
  Eigen::Vector2d release_per_m(double position) const { return value(release_, position); }

 private:
  struct Branch {
    std::vector<Eigen::Vector2d> value, slope;
  };
  static Branch make_branch(const std::vector<double>& position, const std::vector<Eigen::Vector2d>& value);
  Eigen::Vector2d value(const Branch& branch, double position) const;

  std::vector<double> position_;
  Branch pull_, release_;
  Eigen::Vector2d sigma_per_m_, precurvature_per_m_;
  Eigen::Vector2d steepest_;  ///< of both branches, per unit of the position
  double sense_ = 1.0;        ///< -1: k1,0 falls as the position rises
};

}  // namespace palpate
