// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <cmath>
#include <palpate/reproduction/markdown.hpp>
#include <palpate/reproduction/parts.hpp>
#include <palpate/reproduction/virtual_paper.hpp>

/// Corrections to section 4: what the stated R leaves of the curvature, and what no R gives to the scale.
namespace palpate::reproduction {

namespace {

using Whitened = Eigen::Matrix<double, 9, Eigen::Dynamic>;

Linearization linearize(PaperModel& model, const Measurement& data, const StateVector& x) {
  Linearization at;
  model.select(data);
  model.linearize(x, at);
  return at;
}

Whitened whitened(const Linearization& at, const PaperNoise& R) {
  return R.cwiseSqrt().cwiseInverse().asDiagonal() * at.jacobian;
}

Matrix3d mean_information(const std::vector<Linearization>& all, const PaperNoise& R, int first, int rows) {
  Matrix3d information = Matrix3d::Zero();
  for (const Linearization& at : all) {
    const Eigen::MatrixXd G = whitened(at, R).middleRows(first, rows);
    information += G.transpose() * G / static_cast<double>(all.size());
  }
  return information;
}

/// Share of the curvature in the information on the axis of which it tells most: the largest eigenvalue of
/// I_all^-1 I_curvature.
double largest_share(const Matrix3d& curvature, const Matrix3d& all) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d>(curvature, all).eigenvalues().maxCoeff();
}

/// Cramer-Rao bound of one sample, as a row.
void add_bound(MarkdownTable& table, const char* name, const Matrix3d& information) {
  const Vector3d sigma_N = information.llt().solve(Matrix3d::Identity()).diagonal().cwiseSqrt();
  table.rows.push_back({name, fmt::format("{:.3g}", 1e3 * sigma_N(0)), fmt::format("{:.3g}", 1e3 * sigma_N(1)),
                        fmt::format("{:.3g}", 1e3 * sigma_N(2))});
}

/// Of the raw poses of both sensors, at the noise that the catheter states.
Matrix3d pose_information(const Catheter& catheter, const Course& course) {
  ShapeModel model(catheter, MeasurementKind::kPoses, {}, Accuracy::kReference);
  Matrix3d information = Matrix3d::Zero();
  Linearization at;
  ResidualMatrix R;
  for (std::size_t k = 0; k < course.size(); ++k) {
    model.select(course.data[k], ~0U);
    model.linearize(course.force_tip_N[k], at);
    model.noise(R);
    const JacobianMatrix weighted = R.llt().solve(at.jacobian);
    information += at.jacobian.transpose() * weighted / static_cast<double>(course.size());
  }
  return information;
}

std::string list(const Eigen::VectorXd& values) {
  std::string text;
  for (const double v : values) text += (text.empty() ? "" : ", ") + short_number(v);
  return text;
}

}  // namespace

Part make_curvature_channel(const Settings&) {
  const Catheter catheter = paper_catheter();
  const Course course = figure3_course(catheter);
  PaperModel model(catheter, false, paper_noise());
  std::vector<Linearization> all;
  for (std::size_t k = 0; k < course.size(); ++k)
    all.push_back(linearize(model, course.data[k], course.force_tip_N[k]));
  MarkdownTable table{
      {"R", "variance of the curvature [1/m^2]", "share for Fx [%]", "Fy [%]", "Fz [%]", "best direction [%]"}};
  const auto add = [&](const char* name, const PaperNoise& R) {
    const Matrix3d curvature = mean_information(all, R, 6, 3), whole = mean_information(all, R, 0, 9);
    const Vector3d share = 100.0 * curvature.diagonal().cwiseQuotient(whole.diagonal());
    table.rows.push_back({name, short_number(R(6)), short_number(share(0)), short_number(share(1)),
                          short_number(share(2)), short_number(100.0 * largest_share(curvature, whole))});
  };
  const double angle_rad = 0.17 * kRadiansPerDegree;
  const double aurora_per_m2 = 2.0 * std::pow(angle_rad / kSensorDistance_m, 2);
  PaperNoise aurora;
  aurora << Vector3d::Constant(0.28e-3 * 0.28e-3), Vector3d::Constant(angle_rad * angle_rad),
      Vector3d::Constant(aurora_per_m2);
  add("section 4.1, \"1 mm^-2\"", paper_noise());
  add("section 4.1 with 1 m^-2", paper_noise(1.0));
  add("Aurora, 0.28 mm and 0.17 deg", aurora);
  MarkdownTable bounds{{"bound at Aurora's noise, one sample [mN]", "Fx", "Fy", "Fz"}};
  add_bound(bounds, "pose of the tip alone", mean_information(all, aurora, 0, 6));
  add_bound(bounds, "tip and curvature, Eq. (11), taken as independent", mean_information(all, aurora, 0, 9));
  add_bound(bounds, "raw poses of both sensors", pose_information(catheter, course));
  Part part{.title = "Correction: the stated R switches the curvature off"};
  part.markdown =
      "Section 4.1 gives curvature and torsion the variance 1 mm^-2, which is 1e6 m^-2: a sigma of 1000 1/m for "
      "curvatures of "
      "some tens. What the three rows then add to the information J^T R^-1 J on the force, mean over the course of "
      "Figure "
      "3:\n\n" +
      table.text() +
      fmt::format(
          "\nTwo orientations with 0.17 degrees of noise, {:g} mm apart, give a curvature with a variance of {:.2f} "
          "m^-2. So "
          "1 m^-2 is what the sensors do, and a slip of the unit is likely. Even so the curvature tells little beside "
          "the "
          "pose of the tip; and being made of the same orientations, its noise is not independent of theirs, as a "
          "diagonal R says. What the second sensor has to say is in its position, which Eq. (11) leaves out and "
          "`palpate "
          "estimate` takes by default:\n\n",
          1e3 * kSensorDistance_m, aurora_per_m2) +
      bounds.text();
  return part;
}

Part make_scale(const Settings&) {
  const Catheter catheter = paper_catheter();
  const Vector3d force_tip_N(0.05, 0.05, -0.1);
  StateVector x(5);
  x << force_tip_N, kEI1_Nm2, kEI2_Nm2;
  PaperModel model(catheter, true, paper_noise());
  ExactShape shape(catheter);
  const Measurement data = shape.measure(force_tip_N);
  const Linearization at = linearize(model, data, x);
  StateVector size(5);
  size << Vector3d::Constant(0.1), kEI1_Nm2, kEI2_Nm2;
  MarkdownTable table{{"R", "singular values of R^-1/2 J S"}};
  StateVector null_direction;
  for (const double curvature_per_m2 : {1e6, 1.0}) {
    const Eigen::MatrixXd G = whitened(at, paper_noise(curvature_per_m2)) * size.asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(G, Eigen::ComputeThinV);
    table.rows.push_back({fmt::format("curvature {:g} m^-2", curvature_per_m2), list(svd.singularValues())});
    null_direction = svd.matrixV().col(4);
  }
  const StateVector scale = x.cwiseQuotient(size).normalized();
  MarkdownTable scaled{{"factor a on F, EI1, EI2, GJ", "tip moves by [mm]"}};
  for (const double a : {0.5, 2.0, 10.0}) {
    const Measurement other = shape.measure(a * force_tip_N, Vector3d::Constant(std::log(a)));
    const double moved_m = (other.poses[0].T_base_sensor.p - data.poses[0].T_base_sensor.p).norm();
    scaled.rows.push_back({short_number(a), fmt::format("{:.1e}", 1e3 * moved_m)});
  }
  Part part{.title = "Correction: force and stiffness together have no scale"};
  part.markdown =
      "Poses and curvatures carry no newtons: m = K (u - u0) stays true when F, EI1, EI2 and GJ grow by one "
      "factor.\n\n" +
      scaled.text() +
      "\nJacobian of CFSE at F = (0.05, 0.05, -0.1) N, whitened by R, columns in units S of 0.1 N and of the "
      "stiffness:\n\n" +
      table.text() +
      fmt::format(
          "\nThe last one is zero but for rounding, whatever R: four numbers can be told, F / EI and EI1 / EI2. Its "
          "direction is (F, EI1, EI2) itself: the cosine between the two is {:.9f}.\n",
          std::abs(null_direction.dot(scale)));
  return part;
}

}  // namespace palpate::reproduction
