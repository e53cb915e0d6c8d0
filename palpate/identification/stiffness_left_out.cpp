// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <palpate/identification/stiffness_fit.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

namespace {

using stiffness::Fitted;

/// Along the case's own force; for one without, along the mean of the others' forces.
Vector3d direction_of(const LoadCase& left_out, std::span<const LoadCase> others) {
  Vector3d force = left_out.force_base_N;
  if (force.isZero(0.0))
    for (const LoadCase& other : others) force += other.force_base_N;
  if (force.isZero(0.0)) force = Vector3d::UnitX();
  return force.normalized();
}

/// One left-out case: how much more or less force than stated its shape shows. Unknown: what the others told, z = z_hat
/// + root eta with eta of N(0, 1), and the force.
class Prediction {
 public:
  Prediction(const Fitted& fitted, const LoadCase& left_out, const StiffnessOptions& options, const Vector3d& along)
      : fitted_(fitted),
        root_(fitted.covariance.llt().matrixL()),
        model_(fitted.problem.unknowns().described(), left_out, options.own_weight,
               {.shear = fitted.problem.unknowns().described().shears(),
                .turn = true,
                .precurvature = true,
                .force = true},
               along) {}

  bool evaluate(const Eigen::VectorXd& y, Eigen::VectorXd& r, Eigen::MatrixXd& by_y) {
    const Eigen::Index n = fitted_.z.size(), rows = model_.rows();
    const Eigen::VectorXd z = fitted_.z + root_ * y.head(n);
    stiffness::Numbers q = fitted_.problem.unknowns().numbers(z);
    q(stiffness::kExtraForce) = y(n);
    Eigen::Matrix<double, Eigen::Dynamic, stiffness::kNumbers>& by_q = by_q_;
    by_q.resize(rows, stiffness::kNumbers);
    r.resize(rows + n);
    if (!model_.evaluate(q, fitted_.problem.unknown_sigma_m(), r.head(rows), by_q)) return false;
    r.tail(n) = y.head(n);
    by_y.setZero(rows + n, n + 1);
    by_y.topLeftCorner(rows, n) = by_q * fitted_.problem.unknowns().derivative(z) * root_;
    by_y.block(0, n, rows, 1) = by_q.col(stiffness::kExtraForce);
    by_y.bottomLeftCorner(n, n).setIdentity();
    return true;
  }

  int rows() const { return model_.rows() + static_cast<int>(fitted_.z.size()); }

  /// One standard deviation of the force at the last evaluation. Of a stiffness that the others did not tell nothing is
  /// known: it is free here.
  double sigma_N(const Eigen::MatrixXd& by_y) const {
    Eigen::MatrixXd J = by_y;
    for (const stiffness::Unknowns::Stiffness& told : fitted_.problem.unknowns().stiffnesses()) {
      if (told.free) continue;
      J.conservativeResize(J.rows(), J.cols() + 1);
      J.rightCols<1>().setZero();
      J.rightCols<1>().head(model_.rows()) = by_q_.col(row_of(told.name));
    }
    return stiffness::sigma_of(J, by_y.cols() - 1);
  }

  double rms_m() const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < model_.points().size(); ++i) {
      const ShapePoint& measured = model_.load_case().points[i];
      const Vector3d d = measured.position_base_m - model_.points()[i].T_base_point.p;
      for (int axis = 0; axis < (std::isnan(measured.arc_length_m) ? 2 : 3); ++axis)
        if (!std::isnan(d(axis))) sum += d(axis) * d(axis), ++count;
    }
    return count > 0 ? std::sqrt(sum / count) : 0.0;
  }

 private:
  static Eigen::Index row_of(const std::string& name) {
    if (name == "EI1") return stiffness::kLogStiffness;
    if (name == "EI2") return stiffness::kLogStiffness + 1;
    return name == "GJ" ? stiffness::kLogStiffness + 2 : stiffness::kLogShear;
  }

  const Fitted& fitted_;
  Eigen::MatrixXd root_;
  stiffness::CaseModel model_;
  Eigen::Matrix<double, Eigen::Dynamic, stiffness::kNumbers> by_q_;
};

LeftOut predict(const Catheter& catheter, const LoadCase& left_out, std::span<const LoadCase> others,
                const StiffnessOptions& options) {
  const Fitted fitted = stiffness::fit(catheter, others, options);
  LeftOut out;
  out.name = left_out.name;
  out.unknowns = stiffness::unknowns_of(fitted);
  out.stated_N = left_out.force_base_N.norm();
  Prediction prediction(fitted, left_out, options, direction_of(left_out, others));
  Eigen::VectorXd y = Eigen::VectorXd::Zero(fitted.z.size() + 1), r;
  Eigen::MatrixXd by_y;
  if (!prediction.evaluate(y, r, by_y)) throw InputError("no equilibrium under the stated load");
  out.rms_m = prediction.rms_m();
  const stiffness::Residuals residuals = [&](const Eigen::VectorXd& at, Eigen::VectorXd& value, Eigen::MatrixXd& by) {
    return prediction.evaluate(at, value, by);
  };
  stiffness::levenberg_marquardt(residuals, prediction.rows(), y);
  if (!prediction.evaluate(y, r, by_y)) throw InputError("no load along the stated direction explains its shape");
  out.predicted_N = out.stated_N + y(y.size() - 1);
  out.sigma_N = prediction.sigma_N(by_y);
  return out;
}

}  // namespace

std::vector<LeftOut> leave_one_out(const Catheter& catheter, std::span<const LoadCase> cases,
                                   const StiffnessOptions& options) {
  if (cases.size() < 2) throw InputError("one load case: leaving one out needs two or more");
  std::vector<LeftOut> out;
  for (std::size_t left_out = 0; left_out < cases.size(); ++left_out) {
    std::vector<LoadCase> others(cases.begin(), cases.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(left_out));
    try {
      out.push_back(predict(catheter, cases[left_out], others, options));
    } catch (const InputError& error) {
      throw InputError(fmt::format("load case {} left out: {}", cases[left_out].name, error.what()));
    }
  }
  return out;
}

}  // namespace palpate
