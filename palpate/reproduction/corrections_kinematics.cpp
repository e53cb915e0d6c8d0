// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <palpate/reproduction/markdown.hpp>
#include <palpate/reproduction/paper_catheter.hpp>
#include <palpate/reproduction/parts.hpp>

/// Corrections to section 2: Eq. (8) is no tangent; Euler angles are singular where the catheter is used.
namespace palpate::reproduction {

namespace {

/// R = Ry(psi) Rx(theta) Rz(phi), the order stated above Eq. (7).
struct EulerAngles {
  double theta = 0.0, psi = 0.0, phi = 0.0;

  explicit EulerAngles(const Matrix3d& R)
      : theta(std::asin(std::clamp(-R(1, 2), -1.0, 1.0))),
        psi(std::atan2(R(0, 2), R(2, 2))),
        phi(std::atan2(R(1, 0), R(1, 1))) {}

  Vector3d vector() const { return {theta, psi, phi}; }

  /// Eq. (8), as printed.
  Vector3d tangent_eq8() const {
    using std::cos, std::sin;
    return {-cos(phi) * sin(psi) + sin(phi) * sin(theta) * cos(psi),
            sin(phi) * sin(psi) + sin(theta) * cos(phi) * cos(psi), cos(theta) * cos(psi)};
  }
  /// The third column of R.
  Vector3d tangent_column() const {
    using std::cos, std::sin;
    return {cos(theta) * sin(psi), -sin(theta), cos(theta) * cos(psi)};
  }
};

Vector3d wrapped(Vector3d angles) {
  for (double& a : angles) a = std::remainder(a, 2.0 * std::numbers::pi);
  return angles;
}

struct TipByTangents {
  Vector3d eq8_m = Vector3d::Zero(), column_m = Vector3d::Zero(), solver_m = Vector3d::Zero();
};

/// The centreline's end by Simpson's rule over the two tangents, orientations from the rod solution.
TipByTangents integrate_tangents(const Catheter& catheter, const Vector3d& force_tip_N) {
  constexpr int kPanels = 1000;
  std::vector<double> s;
  for (int i = 0; i <= kPanels; ++i) s.push_back(kLength_m * i / kPanels);
  const RodSolver solver(catheter.rod, s, Accuracy::kReference);
  RodSolution<0> shape = solver.make_solution<0>();
  solver.solve({.force_tip_N = force_tip_N}, shape);
  TipByTangents tip;
  for (int i = 0; i <= kPanels; ++i) {
    const EulerAngles angles(shape.points[static_cast<std::size_t>(i)].T_base_local.R);
    const double weight = (i == 0 || i == kPanels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * kLength_m / (3.0 * kPanels);
    tip.eq8_m += weight * angles.tangent_eq8();
    tip.column_m += weight * angles.tangent_column();
  }
  tip.solver_m = shape.T_base_tip.p;
  return tip;
}

std::string millimetres(const Vector3d& p_m) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", 1e3 * p_m.x(), 1e3 * p_m.y(), 1e3 * p_m.z());
}

struct EulerStep {
  double k1_per_m = 0.0, theta_deg = 0.0, euler_deg = 0.0, so3_deg = 0.0;
};

/// Largest residual, over the directions of a turn of 0.17 degrees between prediction and measurement.
EulerStep euler_step(double k1_per_m) {
  const Matrix3d R = exp_so3({k1_per_m * kLength_m, 0.0, 0.0});
  EulerStep step{.k1_per_m = k1_per_m, .theta_deg = EulerAngles(R).theta / kRadiansPerDegree};
  for (int i = 0; i < 24; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 24;
    const Vector3d turn = 0.17 * kRadiansPerDegree * Vector3d(0.0, std::cos(a), std::sin(a));
    const Matrix3d measured = R * exp_so3(turn);
    const Vector3d euler = wrapped(EulerAngles(measured).vector() - EulerAngles(R).vector());
    step.euler_deg = std::max(step.euler_deg, euler.norm() / kRadiansPerDegree);
    step.so3_deg = std::max(step.so3_deg, log_so3(R.transpose() * measured).norm() / kRadiansPerDegree);
  }
  return step;
}

}  // namespace

Part make_eq8(const Settings&) {
  MarkdownTable table{{"k1,0 [1/m]", "tip force [N]", "tip by the rod solution [mm]", "by the third column of R [mm]",
                       "by Eq. (8) [mm]", "Eq. (8) is off by [mm]"}};
  double worst_column_m = 0.0;
  for (const auto& [k1_per_m, force_tip_N] :
       {std::pair{10.0, Vector3d(0.0, 0.0, 0.0)}, std::pair{10.0, Vector3d(0.02, 0.02, -0.05)},
        std::pair{19.41, Vector3d(0.02, 0.02, -0.05)}, std::pair{24.57, Vector3d(0.05, 0.05, -0.1)}}) {
    const TipByTangents tip = integrate_tangents(paper_catheter(k1_per_m), force_tip_N);
    worst_column_m = std::max(worst_column_m, (tip.column_m - tip.solver_m).norm());
    table.rows.push_back({short_number(k1_per_m),
                          fmt::format("({:g}, {:g}, {:g})", force_tip_N.x(), force_tip_N.y(), force_tip_N.z()),
                          millimetres(tip.solver_m), millimetres(tip.column_m), millimetres(tip.eq8_m),
                          fmt::format("{:.2f}", 1e3 * (tip.eq8_m - tip.solver_m).norm())});
  }
  Part part{.title = "Correction: Eq. (8) is not the tangent"};
  part.markdown =
      "For the rotation order stated, R = Ry(psi) Rx(theta) Rz(phi), the tangent is the third column of R, (cos theta "
      "sin "
      "psi, -sin theta, cos theta cos psi). Eq. (8) prints the third row. Eq. (7) is right. Both tangents, integrated "
      "along "
      "the same rod solution:\n\n" +
      table.text() +
      fmt::format(
          "\nThe third column ends within {:.1e} m of the rod solution. Without a force the bend is plane, and Eq. "
          "(8) only mirrors it.\n",
          worst_column_m);
  return part;
}

Part make_euler(const Settings&) {
  const double singular_per_m = 0.5 * std::numbers::pi / kLength_m;
  plot::Series euler{.label = "difference of Euler angles"}, so3{.label = "log(R_predicted^T R_measured)"};
  for (int i = 0; i <= 600; ++i) {
    const EulerStep step = euler_step(0.1 * i);
    euler.x.push_back(step.k1_per_m);
    euler.y.push_back(step.euler_deg);
    so3.x.push_back(step.k1_per_m);
    so3.y.push_back(step.so3_deg);
  }
  MarkdownTable table{{"k1,0 [1/m]", "theta at the tip [deg]", "residual in Euler angles [deg]", "on SO(3) [deg]"}};
  for (const double k1_per_m : {0.0, 10.0, 19.41, 22.0, 22.4, singular_per_m, 24.57, 39.99, 60.0}) {
    const EulerStep step = euler_step(k1_per_m);
    table.rows.push_back({fmt::format("{:.2f}", k1_per_m), fmt::format("{:.1f}", step.theta_deg),
                          fmt::format("{:.2f}", step.euler_deg), fmt::format("{:.2f}", step.so3_deg)});
  }
  Part part{.title = "Correction: Euler angles are singular inside the paper's range"};
  part.figures.push_back(
      {"euler",
       {.title = "Residual of an orientation that is 0.17 degrees off",
        .panels = {{.x_label = "k1,0 [1/m]", .y_label = "residual [deg]", .log_y = true, .series = {euler, so3}}},
        .height_px = 460}});
  part.markdown =
      picture("euler", "Residuals over the bend") + "\n" + table.text() +
      fmt::format(
          "\nBending about d1 turns theta: the unloaded 70 mm shaft reaches 90 degrees at k1,0 = {:.2f} 1/m, "
          "between the paper's 19.41 and 24.57 1/m. There psi and phi are the same turn, and a tip that is "
          "0.17 degrees off, whichever way across, shows up as up to 180 degrees. (theta is read as an "
          "angle between -90 and 90 degrees.) The residual on SO(3) stays 0.17 degrees; it is what the "
          "filters here use.\n",
          singular_per_m);
  return part;
}

}  // namespace palpate::reproduction
