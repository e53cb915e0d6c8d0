// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <palpate/sensing/shape_model.hpp>
#include <tests/sensing/shape_layouts.hpp>

/// What errors of the measured poses do to the residual: ShapeModel::pose_errors() against readings that have them.
namespace palpate {
namespace {

using test::Draws;
using Kind = ParameterKind;

struct Setup {
  const char* name;
  std::function<Catheter()> make;
  MeasurementKind kind = MeasurementKind::kPoses;

  friend void PrintTo(const Setup& setup, std::ostream* out) { *out << setup.name; }
};

const Setup kSetups[] = {
    {"pose", [] { return test::two_sensors(); }},
    {"mixed", [] { return test::mixed_sensors(); }},
    {"mounted", [] { return test::mounted(test::mixed_sensors()); }},
    {"tracked_base", [] { return test::with_tracked_base(test::mounted(test::mixed_sensors())); }},
    {"two_trackers", [] { return test::with_second_tracker(test::mounted(test::mixed_sensors())); }},
    {"own_weight", [] { return test::with_own_weight(test::mixed_sensors()); }},
    {"tip_and_curvature", [] { return test::mounted(test::two_sensors()); }, MeasurementKind::kTipAndCurvature},
    {"tip_and_curvature_tracked_base", [] { return test::with_tracked_base(test::mounted(test::two_sensors())); },
     MeasurementKind::kTipAndCurvature},
    {"tip_and_curvature_two_trackers", [] { return test::with_second_tracker(test::mounted(test::two_sensors())); },
     MeasurementKind::kTipAndCurvature},
};

/// With everything uncertain that moves a pose.
Catheter uncertain(Catheter catheter) {
  catheter.base.position_sigma_m = catheter.base.rotation_sigma_rad = 1e-3;
  for (Sensor& sensor : catheter.sensors) sensor.mount_sigma_m = sensor.bias_m = sensor.bias_rad = 1e-3;
  return catheter;
}

/// The clamp stands elsewhere than its fixed registration says.
Catheter with_clamp_at(Catheter catheter, const Pose& T_stated_true) {
  catheter.base.T_tracker_base = catheter.base.T_tracker_base * T_stated_true;
  return catheter;
}

/// The base sensor shows itself shifted and turned (base axes), so that the clamp, too, seems to be elsewhere.
void mislead(SensorReading& base_reading, const Matrix3d& R_tracker_base, const Pose& error) {
  const Matrix3d turn = R_tracker_base * error.R * R_tracker_base.transpose();
  base_reading =
      test::reading_of({turn * test::rotation_of(base_reading), base_reading.position_m + R_tracker_base * error.p});
}

class PoseErrors : public ::testing::TestWithParam<Setup> {
 protected:
  /// What is registered when parameter `p` of the true setup is `b`, the file's being 0.
  Measurement measured_with(const UncertainParameter& p, double b) {
    const Vector3d step = b * Vector3d::Unit(p.axis);
    const bool clamp = p.kind == Kind::kBasePosition || p.kind == Kind::kBaseRotation;
    const bool turn = p.kind == Kind::kBaseRotation || p.kind == Kind::kSensorRotation;
    const Pose error{Draws::turn(turn ? step : Vector3d::Zero()), turn ? Vector3d::Zero() : step};
    Catheter real = catheter_;
    if (clamp && !real.base.tracked) real = with_clamp_at(real, error);
    if (p.kind == Kind::kMountPosition) real.sensors[static_cast<std::size_t>(p.sensor)].T_local_sensor.p += step;
    TrackerFrame frame = test::true_frame(real, {.force_tip_N = force_}).frame;
    if (clamp && real.base.tracked)  // it reads -b, where the clamp is b from what it shows
      mislead(frame.readings.back(), real.base.T_tracker_base.R, {error.R.transpose(), -error.p});
    Measurement out;
    register_frame(catheter_, frame, out);
    for (int k = 0; k < out.count; ++k) {
      Measurement::SensorPose& pose = out.poses[static_cast<std::size_t>(k)];
      if (pose.sensor != p.sensor || p.kind == Kind::kMountPosition) continue;
      pose.T_base_sensor = {error.R * pose.T_base_sensor.R, pose.T_base_sensor.p + error.p};
    }
    return out;
  }

  ResidualVector residual_of(const Measurement& measurement) {
    Linearization at;
    model_.select(measurement, test::kAllSensors);
    EXPECT_TRUE(model_.linearize(StateVector(force_), at));
    return at.residual;
  }

  Eigen::MatrixXd pose_errors() {
    register_frame(catheter_, test::exact_frame(catheter_, force_), measurement_);
    model_.select(measurement_, test::kAllSensors);
    PoseErrorMatrix B;
    model_.pose_errors(B);
    EXPECT_EQ(B.rows(), model_.rows());
    EXPECT_EQ(B.cols(), parameters_.pose_count());
    return B;
  }

  Eigen::VectorXd slope_of(const UncertainParameter& p) {
    constexpr double h = 1e-4;  // m or rad: h^2 leaves 1e-8, rounding 1e-11
    return (residual_of(measured_with(p, h)) - residual_of(measured_with(p, -h))) / (2.0 * h);
  }

  const UncertainParameter& parameter(Eigen::Index j) const {
    return parameters_.all[static_cast<std::size_t>(parameters_.rod_count + j)];
  }

  const Vector3d force_{0.03, 0.02, -0.06};
  Catheter catheter_ = uncertain(GetParam().make());
  UncertainParameters parameters_ = uncertain_parameters(catheter_, {.consider = true});
  ShapeModel model_{catheter_, GetParam().kind, parameters_, Accuracy::kReference};
  Measurement measurement_;
};

TEST_P(PoseErrors, AreWhatThePerturbedReadingsDoToTheResidual) {
  const Eigen::MatrixXd B = pose_errors();
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    const UncertainParameter& p = parameter(j);
    const bool point =
        p.sensor >= 0 && catheter_.sensors[static_cast<std::size_t>(p.sensor)].kind == SensorKind::kPosition;
    if (point && p.kind == Kind::kMountPosition) continue;  // along unknown axes: below
    const Eigen::VectorXd slope = slope_of(p);
    EXPECT_LT((B.col(j) - slope).cwiseAbs().maxCoeff(), 1e-6 * std::max(1.0, slope.cwiseAbs().maxCoeff()))
        << "kind " << static_cast<int>(p.kind) << ", axis " << p.axis << ", sensor " << p.sensor;
  }
}

/// A mounting error alike along all axes is a ball, in whatever axes: what the three columns do together must agree.
TEST_P(PoseErrors, MountingErrorsOfASensorSpreadTheResidualAsTheyShould) {
  const Eigen::MatrixXd B = pose_errors();
  for (int sensor = 0; sensor < static_cast<int>(catheter_.sensors.size()); ++sensor) {
    Eigen::MatrixXd columns(B.rows(), 3), slopes(B.rows(), 3);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = parameters_.find(Kind::kMountPosition, axis, sensor);
      columns.col(axis) = B.col(i - parameters_.rod_count);
      slopes.col(axis) = slope_of(parameters_.all[static_cast<std::size_t>(i)]);
    }
    EXPECT_LT((columns * columns.transpose() - slopes * slopes.transpose()).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST_P(PoseErrors, EverySensorsOwnErrorsStayInItsRowsAndTheClampsCancelInTheCurvature) {
  const Eigen::MatrixXd B = pose_errors();
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    const UncertainParameter& p = parameter(j);
    for (int row = 0; row < B.rows(); ++row) {
      const int channel = model_.channels()[static_cast<std::size_t>(row)];
      const bool curvature = channel >= 6 * kMaxSensors, of_clamp = p.sensor < 0;
      const bool own_base = !curvature && catheter_.sensors[static_cast<std::size_t>(channel / 6)].T_tracker_base;
      const bool cancels = curvature && !catheter_.sensors.back().T_tracker_base;
      const bool foreign = !curvature && channel / 6 != p.sensor;
      if (of_clamp ? own_base || cancels : foreign) {
        EXPECT_NEAR(B(row, j), 0.0, 1e-11) << row << ", " << j;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, PoseErrors, ::testing::ValuesIn(kSetups),
                         [](const auto& setup) { return std::string(setup.param.name); });

/// Such parameters move nothing by themselves, and those behind p_rod do not depend on how the rod is bent.
TEST(PoseErrorColumns, StartBehindTheRodsAndTheStiffnessRateMovesNothing) {
  const Catheter catheter = uncertain(test::with_all(TendonModel::kCouple, test::mixed_sensors()));
  const UncertainParameters all = uncertain_parameters(catheter, {.consider = true, .estimate_stiffness = true});
  const UncertainParameters poses = uncertain_parameters(uncertain(test::mixed_sensors()), {.consider = true});
  ASSERT_EQ(poses.rod_count, 0);
  Measurement measurement;
  register_frame(catheter, test::exact_frame(catheter, {0.02, 0.0, -0.05}), measurement);
  const auto errors = [&](const UncertainParameters& parameters) {
    ShapeModel model(catheter, MeasurementKind::kPoses, parameters);
    model.select(measurement, test::kAllSensors);
    PoseErrorMatrix B;
    model.pose_errors(B);
    return B;
  };
  const PoseErrorMatrix B = errors(all);
  ASSERT_EQ(B.cols(), poses.size() + 1);
  EXPECT_EQ(B.leftCols(poses.size()), errors(poses));
  EXPECT_TRUE(B.rightCols(1).isZero(0.0));
}

}  // namespace
}  // namespace palpate
