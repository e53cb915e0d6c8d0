// SPDX-License-Identifier: Apache-2.0
#include <palpate/observer/frame_model.hpp>

namespace palpate {

void FramePrior::set(const SeenBelief& seen, int states, double wider_N) {
  const Eigen::Index n = states, pose = seen.mean.size() - n;
  x.mean = seen.mean.head(n);
  x.covariance = seen.covariance.topLeftCorner(n, n);
  x.covariance.diagonal().head<3>().array() += wider_N * wider_N;
  pose_by_x.resize(pose, n);
  pose_covariance.resize(pose, pose);
  if (pose == 0) return;
  using PoseRows =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxStates, kMaxPoseParameters>;
  const PoseRows P_xb = seen.covariance.topRightCorner(n, pose);
  const PoseRows gain = Eigen::LLT<StateMatrix>(x.covariance).solve(P_xb);
  pose_by_x = gain.transpose();
  pose_covariance = seen.covariance.bottomRightCorner(pose, pose);
  pose_covariance -= pose_by_x.lazyProduct(P_xb);
}

FrameModel::FrameModel(ShapeModel& shape, const NoiseAdaptation* adaptation, const FramePrior& prior)
    : shape_(shape), adaptation_(adaptation), prior_(prior) {
  shape_.pose_errors(pose_errors_);
  if (pose_errors_.cols() == 0) return;
  along_x_ = pose_errors_.lazyProduct(prior_.pose_by_x);
  const PoseErrorMatrix BP = pose_errors_.lazyProduct(prior_.pose_covariance);
  pose_covariance_ = BP.lazyProduct(pose_errors_.transpose());
}

void FrameModel::white_noise(ResidualMatrix& R) const {
  shape_.noise(R);
  if (adaptation_ != nullptr) adaptation_->apply(shape_.channels(), R);
}

void FrameModel::noise(ResidualMatrix& R) const {
  white_noise(R);
  if (pose_errors_.cols() > 0) R += pose_covariance_;
}

bool FrameModel::linearize(const StateVector& x, Linearization& at) {
  if (!shape_.linearize(x, at)) return false;
  if (pose_errors_.cols() == 0) return true;
  at.residual -= along_x_.lazyProduct(x - prior_.x.mean);
  at.jacobian += along_x_;
  return true;
}

void FrameModel::line(const UpdateLine& update, FrameLine& out) const {
  const Eigen::Index rod = update.x0.size() - 3, pose = pose_errors_.cols();
  out.force_N = update.x0.head<3>();
  out.parameters.setZero(rod + pose);
  out.parameters.head(rod) = update.x0.tail(rod);
  out.residual = update.at_x0.residual;
  JacobianMatrix J = update.at_x0.jacobian;
  if (pose > 0) {
    out.residual += along_x_.lazyProduct(update.x0 - prior_.x.mean);
    J -= along_x_;
  }
  out.by_force = J.leftCols<3>();
  out.by_parameters.resize(J.rows(), rod + pose);
  out.by_parameters.leftCols(rod) = J.rightCols(rod);
  out.by_parameters.rightCols(pose) = pose_errors_;
  white_noise(out.noise);
  if (update.more_noise.size() > 0) out.noise += update.more_noise;
  compress(out);
}

}  // namespace palpate
