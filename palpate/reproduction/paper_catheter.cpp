// SPDX-License-Identifier: Apache-2.0
#include <palpate/reproduction/paper_catheter.hpp>

namespace palpate::reproduction {

Catheter paper_catheter(double k1_per_m) {
  Catheter catheter;
  catheter.name = "ThermoCool SF, 7F (paper, Table 2)";
  catheter.rod = uniform_rod(kLength_m, {kEI1_Nm2, kEI2_Nm2, kGJ_Nm2}, {k1_per_m, 0.0, 0.0});
  for (const auto& [name, s] : {std::pair{"tip", kLength_m}, std::pair{"shaft", kLength_m - kSensorDistance_m}}) {
    Sensor& sensor = catheter.sensors.emplace_back();
    sensor.name = name;
    sensor.arc_length_m = s;
  }
  return catheter;
}

namespace {

std::vector<double> stations(const Catheter& catheter) {
  std::vector<double> s;
  for (const Sensor& sensor : catheter.sensors) s.push_back(sensor.arc_length_m);
  return s;
}

}  // namespace

ExactShape::ExactShape(const Catheter& catheter)
    : rod_(catheter.rod, stations(catheter), Accuracy::kReference), shape_(rod_.make_solution<0>()) {}

Measurement ExactShape::measure(const Vector3d& force_tip_N, const Vector3d& log_stiffness) {
  rod_.solve({.force_tip_N = force_tip_N, .log_stiffness = log_stiffness}, shape_);
  Measurement measurement;
  for (std::size_t i = 0; i < shape_.points.size(); ++i)
    measurement.poses[i] = {static_cast<int>(i), shape_.points[i].T_base_local};
  measurement.count = static_cast<int>(shape_.points.size());
  return measurement;
}

}  // namespace palpate::reproduction
