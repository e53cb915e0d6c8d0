// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <palpate/identification/registration_noise.hpp>

namespace palpate {

namespace {

/// Error of one mean pose: of its position, and of its rotation, both in reference axes.
struct PoseError {
  const Sensor* sensor = nullptr;
  Vector3d place_m = Vector3d::Zero();  ///< in the reference frame
  int frames = 1;
};

std::vector<PoseError> list_errors(const RegistrationModel& model) {
  std::vector<PoseError> errors;
  for (const RegistrationReading& reading : model.readings())
    errors.push_back({&model.catheter().sensors[static_cast<std::size_t>(reading.sensor)],
                      reading.mean->T_base_sensor.p, reading.mean->count});
  if (!model.catheter().base.tracked) return errors;
  std::vector<int> frames(static_cast<std::size_t>(model.positions()), 1);
  for (const RegistrationReading& reading : model.readings()) {
    int& most = frames[static_cast<std::size_t>(reading.position)];
    most = std::max(most, reading.mean->count);
  }
  for (const int count : frames) errors.push_back({&model.catheter().base.sensor, Vector3d::Zero(), count});
  return errors;
}

Eigen::MatrixXd covariance_of(const std::vector<PoseError>& errors, double bias_length_m) {
  constexpr double kNotQuiteOne = 0.9999;  // two readings in one place: still a definite covariance
  const auto size = static_cast<Eigen::Index>(errors.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(6 * size, 6 * size);
  for (Eigen::Index a = 0; a < size; ++a) {
    const PoseError& one = errors[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < size; ++b) {
      const PoseError& other = errors[static_cast<std::size_t>(b)];
      const double d = (one.place_m - other.place_m).norm() / bias_length_m;
      const double alike = a == b ? 1.0 : kNotQuiteOne * std::exp(-0.5 * d * d);
      C.block<3, 3>(6 * a, 6 * b).diagonal().setConstant(alike * one.sensor->bias_m * other.sensor->bias_m / 3.0);
      C.block<3, 3>(6 * a + 3, 6 * b + 3)
          .diagonal()
          .setConstant(alike * one.sensor->bias_rad * other.sensor->bias_rad / 3.0);
    }
    C.block<3, 3>(6 * a, 6 * a).diagonal().array() += one.sensor->noise_m.squaredNorm() / 3.0 / one.frames;
    C.block<3, 3>(6 * a + 3, 6 * a + 3).diagonal().array() += std::pow(one.sensor->noise_rad, 2) / one.frames;
  }
  return C;
}

/// Derivatives of all residuals by all pose errors. A base sensor that is moved by rho and turned by theta, in its own
/// axes, shows every other sensor moved by -rho + p x theta and turned by -theta.
Eigen::MatrixXd residuals_by_errors(const RegistrationModel& model, std::size_t errors) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(model.rows(), 6 * static_cast<Eigen::Index>(errors));
  const auto readings = static_cast<Eigen::Index>(model.readings().size());
  for (Eigen::Index a = 0; a < readings; ++a) {
    const RegistrationReading& reading = model.readings()[static_cast<std::size_t>(a)];
    const Pose& measured = reading.mean->T_base_sensor;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(reading.rows, 6);
    rows.topLeftCorner<3, 3>().setIdentity();
    rows.bottomRightCorner(reading.rows - 3, 3) = measured.R.transpose().topRows(reading.rows - 3);
    M.block(reading.first_row, 6 * a, reading.rows, 6) = rows;
    if (!model.catheter().base.tracked) continue;
    Eigen::Matrix<double, 6, 6> by_base = -Eigen::Matrix<double, 6, 6>::Identity();
    by_base.topRightCorner<3, 3>() = hat(measured.p);
    M.block(reading.first_row, 6 * (readings + reading.position), reading.rows, 6) = rows * by_base;
  }
  return M;
}

}  // namespace

Eigen::MatrixXd registration_noise(const RegistrationModel& model) {
  const std::vector<PoseError> errors = list_errors(model);
  const Eigen::MatrixXd M = residuals_by_errors(model, errors.size());
  return M * covariance_of(errors, model.catheter().bias_length_m) * M.transpose();
}

}  // namespace palpate
