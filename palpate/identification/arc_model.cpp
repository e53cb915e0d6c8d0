// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/identification/arc_model.hpp>

namespace palpate {

namespace {

constexpr int kPieces = 24;  // of a shaft whose curvature changes along it

/// The rod with the arc in its flexible sections; with a change along the shaft these are cut into pieces.
Rod bent(const Rod& described, const Vector3d& precurvature, const Eigen::Vector2d& change_along) {
  Rod rod = described;
  const double L = rod.length_m();
  if (!change_along.isZero(0.0)) {
    rod.sections.clear();
    for (const Section& section : described.sections) {
      const double step = (section.to_m - section.from_m) / kPieces;
      for (int i = 0; i < kPieces; ++i) {
        Section piece = section;
        piece.from_m = i == 0 ? section.from_m : rod.sections.back().to_m;
        piece.to_m = i + 1 == kPieces ? section.to_m : section.from_m + step * (i + 1);
        rod.sections.push_back(piece);
      }
    }
  }
  for (Section& section : rod.sections) {
    if (section.rigid) continue;
    const double middle = 0.5 * (section.from_m + section.to_m) / L - 0.5;
    section.precurvature_per_m = precurvature + middle * Vector3d(change_along.x(), change_along.y(), 0.0);
  }
  return rod;
}

}  // namespace

ArcModel::ArcModel(const Catheter& catheter, std::vector<ArcObservation> observations, std::vector<ArcPrior> priors)
    : rod_(catheter.rod), observations_(std::move(observations)), priors_(std::move(priors)) {
  for (const ArcObservation& seen : observations_) {
    arc_lengths_.push_back(seen.sensor.arc_length_m);
    for (const double p : seen.measured.p) data_rows_ += std::isfinite(p) ? 1 : 0;
    data_rows_ += rows_of(seen.sensor.kind) - 3;
  }
}

void ArcModel::set_point_sigma(double sigma_m) {
  for (ArcObservation& seen : observations_)
    if (seen.sensor.name.empty()) seen.sigma_m.setConstant(sigma_m);
}

RodSolution<3> ArcModel::solve(const Vector3d& precurvature, const Eigen::Vector2d& change_along, bool& solved) const {
  const RodSolver solver(bent(rod_, precurvature, change_along), arc_lengths_, Accuracy::kReference);
  RodSolution<3> shape = solver.make_solution<3>();
  WeightWorkspace<3> workspace = make_weight_workspace<3>(solver);
  LoadDirections<3> directions;
  directions.precurvature_per_m.setIdentity();
  solved = solve_under_weight(solver, TipLoad{}, directions, workspace, shape).converged;
  return shape;
}

/// d position = d T_start (exp(theta) p_base + rho), d rotation on the body side; the weight keeps its direction in the
/// base.
PredictedSensor<9> ArcModel::predict(const ArcObservation& seen, const RodPoint& point,
                                     const RodPointTangent<3>& tangent, const ArcVector& x) const {
  const PredictedSensor<3> own = predict_sensor(seen.sensor, point, tangent);
  const Matrix3d turn = right_jacobian(x.tail<3>());
  const Pose T_frame_base = this->T_frame_base(x);
  PredictedSensor<9> out;
  out.T_base_sensor = T_frame_base * own.T_base_sensor;
  out.rotation << own.rotation, Matrix3d::Zero(), own.T_base_sensor.R.transpose() * turn;
  out.position_m << T_frame_base.R * own.position_m, T_start_.R, -T_frame_base.R * hat(own.T_base_sensor.p) * turn;
  return out;
}

bool ArcModel::residuals(const ArcVector& x, const Eigen::Vector2d& change_along, Eigen::VectorXd& r,
                         Eigen::Matrix<double, Eigen::Dynamic, 9>* by_x) const {
  bool solved = false;
  const RodSolution<3> shape = solve(x.head<3>(), change_along, solved);
  r.setZero(rows());
  if (by_x) by_x->setZero(rows(), 9);
  Linearization at;
  int row = 0;
  const auto put = [&](int i, double sigma) {
    r(row) = at.residual(i) / sigma;
    if (by_x) by_x->row(row) = -at.jacobian.row(i) / sigma;
    ++row;
  };
  for (std::size_t k = 0; k < observations_.size(); ++k) {
    const ArcObservation& seen = observations_[k];
    const int count = rows_of(seen.sensor.kind);
    at.residual.resize(count);
    at.jacobian.resize(count, 9);
    append_sensor_rows(seen.sensor.kind, predict(seen, shape.points[k], shape.tangents[k], x), seen.measured, 0, at);
    for (int i = 0; i < 3; ++i)
      if (std::isfinite(seen.measured.p(i))) put(i, seen.sigma_m(i));
    for (int i = 3; i < count; ++i) put(i, seen.sigma_rad);
  }
  for (const ArcPrior& prior : priors_) {
    r(row) = (prior.value - x(prior.entry)) / prior.sigma;
    if (by_x) (*by_x)(row, prior.entry) = -1.0 / prior.sigma;
    ++row;
  }
  return solved && r.allFinite();
}

bool ArcModel::evaluate(const Eigen::VectorXd& z, Eigen::VectorXd& r, Eigen::MatrixXd* J) const {
  if (!z.allFinite()) return false;
  Eigen::Matrix<double, Eigen::Dynamic, 9> by_x;
  const bool good = residuals(state(z), Eigen::Vector2d::Zero(), r, J ? &by_x : nullptr);
  if (J) *J = by_x * M_;
  return good;
}

std::vector<Pose> ArcModel::poses(const ArcVector& x) const {
  bool solved = false;
  const RodSolution<3> shape = solve(x.head<3>(), Eigen::Vector2d::Zero(), solved);
  std::vector<Pose> out;
  out.reserve(observations_.size());
  for (std::size_t k = 0; k < observations_.size(); ++k)
    out.push_back(T_frame_base(x) * shape.points[k].T_base_local * observations_[k].sensor.T_local_sensor);
  return out;
}

/// A central difference over a hundredth of a radian of bend.
Eigen::VectorXd ArcModel::by_change_along(const Eigen::VectorXd& z, int axis) const {
  const double step = 0.01 / rod_.length_m();
  Eigen::VectorXd above, below;
  residuals(state(z), step * Eigen::Vector2d::Unit(axis), above, nullptr);
  residuals(state(z), -step * Eigen::Vector2d::Unit(axis), below, nullptr);
  return (above - below) / (2.0 * step);
}

}  // namespace palpate
