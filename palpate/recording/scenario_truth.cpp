// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <palpate/math/units.hpp>
#include <palpate/recording/scenario_truth.hpp>
#include <random>

namespace palpate {
namespace {

constexpr std::uint64_t kOwnDraws = 0x7472757468ULL;  // else the run's other draws by the same seed are the same

using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr NumberRange kCurvature = {-1000.0, 1000.0, "a curvature in 1/m, at most 1000"};
constexpr NumberRange kFactor = {0.05, 20.0, "a factor of the file's stiffness, 0.05..20"};
constexpr NumberRange kShift_mm = {-1000.0, 1000.0, "a shift in mm, at most 1000"};
constexpr NumberRange kTurn_deg = {-180.0, 180.0, "an angle in degrees, at most 180"};

/// All flexible sections alike.
void bend_by(const Vector3d& change_per_m, Catheter& catheter) {
  for (Section& section : catheter.rod.sections)
    if (!section.rigid) section.precurvature_per_m += change_per_m;
}

void stiffen_by(const Vector3d& factor, Catheter& catheter) {
  for (Section& section : catheter.rod.sections) section.stiffness_Nm2 = section.stiffness_Nm2.cwiseProduct(factor);
}

/// `shift_m` and `turn_rad` in base axes, from where the file has the clamp. A tracked base is off by what its sensor
/// is mounted wrongly.
void move_base(const Vector3d& shift_m, const Vector3d& turn_rad, Catheter& catheter) {
  const Pose off{exp_so3(turn_rad), shift_m};
  BaseRegistration& base = catheter.base;
  if (base.tracked)
    base.sensor.T_local_sensor = off.inverse() * base.sensor.T_local_sensor;
  else
    base.T_tracker_base = base.T_tracker_base * off;
}

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

/// Position and rotation of the base, from its covariance where the file has one.
Vector6d draw_base(const BaseRegistration& base, Draws& draws) {
  Vector6d normal;
  normal << draws.normal3(), draws.normal3();
  if (base.covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(*base.covariance);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * normal;
  }
  normal.head<3>() *= base.position_sigma_m;
  normal.tail<3>() *= base.rotation_sigma_rad;
  return normal;
}

}  // namespace

Catheter draw_catheter(const Catheter& believed, std::uint64_t seed) {
  Catheter truth = believed;
  Draws draws(seed ^ kOwnDraws);
  const double shared = std::sqrt(believed.stiffness_correlation) * draws.normal();
  const Vector3d own = std::sqrt(1.0 - believed.stiffness_correlation) * draws.normal3();
  const Vector3d factor = (believed.stiffness_sigma_fraction * (own + Vector3d::Constant(shared))).array().exp();
  stiffen_by(factor, truth);
  bend_by(believed.precurvature_sigma_per_m.cwiseProduct(draws.normal3()), truth);
  const Vector6d base = draw_base(believed.base, draws);
  move_base(base.head<3>(), base.tail<3>(), truth);
  for (Sensor& sensor : truth.sensors) sensor.T_local_sensor.p += sensor.mount_sigma_m * draws.normal3();
  return truth;
}

Catheter read_truth(const TomlTable& root, const Catheter& believed, std::uint64_t seed, bool& drawn) {
  drawn = false;
  const auto table =
      root.table("truth", {"draw", "precurvature_per_m", "stiffness_factor", "base_position_mm", "base_rotation_deg"});
  if (!table) return believed;
  drawn = table->flag("draw", false);
  for (const char* key : {"precurvature_per_m", "stiffness_factor", "base_position_mm", "base_rotation_deg"})
    if (drawn && table->has(key)) table->refuse(key, "either draw = true, or what is true by its number");
  if (drawn) return draw_catheter(believed, seed);
  Catheter truth = believed;
  if (const auto k = table->optional_vector<3>("precurvature_per_m", kCurvature))
    bend_by(*k - believed.precurvature_per_m(), truth);
  const toml::node* factor = table->find("stiffness_factor");
  if (factor != nullptr && factor->is_array())
    stiffen_by(*table->optional_vector<3>("stiffness_factor", kFactor), truth);
  else
    stiffen_by(Vector3d::Constant(table->number("stiffness_factor", kFactor, 1.0)), truth);
  const Vector3d shift_mm = table->optional_vector<3>("base_position_mm", kShift_mm).value_or(Vector3d::Zero());
  const Vector3d turn_deg = table->optional_vector<3>("base_rotation_deg", kTurn_deg).value_or(Vector3d::Zero());
  move_base(shift_mm * kMetresPerMillimetre, turn_deg * kRadiansPerDegree, truth);
  return truth;
}

}  // namespace palpate
