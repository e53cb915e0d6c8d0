// SPDX-License-Identifier: Apache-2.0
#include <ceres/numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <palpate/reproduction/independent_map.hpp>

namespace palpate::reproduction {

namespace {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix93d = Eigen::Matrix<double, 9, 3>;

/// r(F) of one frame, unweighted: position, orientation, curvature and torsion.
class FrameResidual {
 public:
  explicit FrameResidual(const Catheter& catheter)
      : rod_(catheter.rod, std::array{catheter.sensors[0].arc_length_m, catheter.sensors[1].arc_length_m},
             Accuracy::kReference),
        shape_(rod_.make_solution<0>()),
        distance_m_(catheter.sensors[0].arc_length_m - catheter.sensors[1].arc_length_m) {}

  void set_data(const Measurement& data) {
    tip_ = data.poses[0].T_base_sensor;
    omega_per_m_ = log_so3(data.poses[1].T_base_sensor.R.transpose() * tip_.R) / distance_m_;
  }

  Vector9d operator()(const Vector3d& force_tip_N) {
    rod_.solve({.force_tip_N = force_tip_N}, shape_);
    const Pose &tip = shape_.points[0].T_base_local, &behind = shape_.points[1].T_base_local;
    Vector9d r;
    r << tip_.p - tip.p, log_so3(tip.R.transpose() * tip_.R),
        omega_per_m_ - log_so3(behind.R.transpose() * tip.R) / distance_m_;
    return r;
  }

  /// By central differences.
  Matrix93d jacobian(const Vector3d& force_tip_N) {
    constexpr double kStep_N = 1e-6;
    Matrix93d J;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep_N * Vector3d::Unit(axis);
      J.col(axis) = ((*this)(force_tip_N - step) - (*this)(force_tip_N + step)) / (2.0 * kStep_N);
    }
    return J;
  }

 private:
  RodSolver rod_;
  RodSolution<0> shape_;
  double distance_m_;
  Pose tip_;
  Vector3d omega_per_m_;
};

/// The whole cost as 12 weighted residuals of F; Ceres varies F in units of the prediction's sigma.
struct WeightedCost {
  FrameResidual* frame;
  PaperNoise R;
  Vector3d mean_N;
  Matrix3d root;  ///< L, P- = L L^T

  bool operator()(const double* z, double* residual) const {
    const Eigen::Map<const Vector3d> scaled(z);
    Eigen::Map<Eigen::Matrix<double, 12, 1>> r(residual);
    r.head<9>() = (*frame)(mean_N + root * scaled).cwiseQuotient(R.cwiseSqrt());
    r.tail<3>() = scaled;
    return r.allFinite();
  }
};

Vector3d minimise(const WeightedCost& cost) {
  using Numeric = ceres::NumericDiffCostFunction<WeightedCost, ceres::CENTRAL, 12, 3>;
  Vector3d z = Vector3d::Zero();
  ceres::Problem problem;
  problem.AddResidualBlock(new Numeric(new WeightedCost(cost)), nullptr, z.data());
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-20;
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return cost.mean_N + cost.root * z;
}

}  // namespace

std::vector<Vector3d> independent_map_errors(const Catheter& catheter, const Course& course, double Q_N2,
                                             const std::vector<PaperNoise>& R, const Vector3d& start_N) {
  FrameResidual frame(catheter);
  Vector3d force_N = start_N;
  Matrix3d P = Q_N2 * Matrix3d::Identity();
  std::vector<Vector3d> errors_N;
  for (std::size_t k = 0; k < course.size(); ++k) {
    frame.set_data(course.data[k]);
    P += Q_N2 * Matrix3d::Identity();
    const PaperNoise& noise = R[std::min(k, R.size() - 1)];
    force_N = minimise({.frame = &frame, .R = noise, .mean_N = force_N, .root = P.llt().matrixL()});
    const Matrix93d J = frame.jacobian(force_N);
    const Matrix3d information = J.transpose() * noise.cwiseInverse().asDiagonal() * J;
    P = (Matrix3d::Identity() + P * information).lu().solve(P);
    P = (0.5 * (P + P.transpose())).eval();
    errors_N.emplace_back(force_N - course.force_tip_N[k]);
  }
  return errors_N;
}

}  // namespace palpate::reproduction
