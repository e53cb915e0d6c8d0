// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <diagnostic_msgs/msg/diagnostic_array.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <geometry_msgs/msg/wrench_stamped.hpp>
#include <memory>
#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>
#include <palpate/recording/catheter_file.hpp>
#include <palpate_ros2/frame_assembler.hpp>
#include <palpate_ros2/msg/force_with_covariance_stamped.hpp>
#include <rclcpp/rclcpp.hpp>

namespace palpate_ros2 {

using diagnostic_msgs::msg::DiagnosticArray;
using geometry_msgs::msg::WrenchStamped;
using Pose = geometry_msgs::msg::PoseStamped;
using msg::ForceWithCovarianceStamped;

/// Sensors of the catheter in the order of a frame's readings: the base's, if it is tracked, comes last.
std::vector<std::string> sensor_names(const palpate::Catheter& catheter) {
  std::vector<std::string> names;
  for (const palpate::Sensor& sensor : catheter.sensors) names.push_back(sensor.name);
  if (catheter.base.tracked) names.push_back(catheter.base.sensor.name);
  return names;
}

/// Poses in, force out. All callbacks run in one thread.
class Bridge : public rclcpp::Node {
 public:
  Bridge()
      : Node("palpate_bridge"),
        file_(palpate::read_catheter_file(declare_parameter<std::string>("catheter"))),
        observer_(file_.catheter, file_.observer),
        assembler_(sensor_names(file_.catheter).size()),
        tip_frame_(declare_parameter<std::string>("tip_frame", "palpate_tip")),
        tracker_frame_(declare_parameter<std::string>("tracker_frame", "")),
        stale_after_(declare_parameter<double>("stale_after_s", 0.2)) {
    wrench_ = create_publisher<WrenchStamped>("~/wrench", 10);
    force_ = create_publisher<ForceWithCovarianceStamped>("~/force", 10);
    diagnostics_ = create_publisher<DiagnosticArray>("/diagnostics", 10);
    for (const std::string& warning : file_.warnings) RCLCPP_WARN(get_logger(), "%s", warning.c_str());
    subscribe();
    watchdog_ = create_wall_timer(stale_after_ / 2.0, [this] { watch(); });
  }

 private:
  using Clock = std::chrono::steady_clock;

  void subscribe() {
    const std::vector<std::string> names = sensor_names(file_.catheter);
    std::vector<std::string> topics;
    for (const std::string& name : names) topics.push_back("~/" + name + "/pose");
    topics = declare_parameter<std::vector<std::string>>("sensor_topics", topics);
    if (topics.size() != names.size())
      throw palpate::InputError("sensor_topics: expected " + std::to_string(names.size()) +
                                " topics, one a sensor of the catheter file and in its order, found " +
                                std::to_string(topics.size()));
    for (std::size_t i = 0; i < topics.size(); ++i)
      poses_.push_back(create_subscription<Pose>(topics[i], rclcpp::SensorDataQoS(),
                                                 [this, i](const Pose& message) { take(i, message); }));
  }

  void take(std::size_t sensor, const Pose& message) {
    if (!tracker_frame_.empty() && message.header.frame_id != tracker_frame_) {
      RCLCPP_WARN_THROTTLE(get_logger(), *get_clock(), 1000, "%s: expected poses in %s, found %s",
                           poses_[sensor]->get_topic_name(), tracker_frame_.c_str(), message.header.frame_id.c_str());
      return;
    }
    for (const FrameAssembler::Frame& ready : assembler_.add(sensor, message)) {
      latest_ = Clock::now();
      publish(observer_.update(ready.frame), to_stamp<builtin_interfaces::msg::Time>(ready.stamp_ns));
    }
  }

  void watch() {
    if (Clock::now() - latest_ > stale_after_) publish(stale_estimate(), now());
  }

  void publish(const palpate::Estimate& estimate, const builtin_interfaces::msg::Time& stamp) {
    WrenchStamped wrench;
    ForceWithCovarianceStamped force;
    DiagnosticArray diagnostics;
    wrench.header.stamp = force.header.stamp = diagnostics.header.stamp = stamp;
    wrench.header.frame_id = force.header.frame_id = tip_frame_;
    set_wrench(estimate, wrench.wrench);
    set_force(estimate, force);
    set_diagnostics(estimate, file_.catheter.name, assembler_.late(), diagnostics.status.emplace_back());
    wrench_->publish(wrench);
    force_->publish(force);
    diagnostics_->publish(diagnostics);
  }

  palpate::CatheterFile file_;
  palpate::ForceObserver observer_;
  FrameAssembler assembler_;
  std::string tip_frame_, tracker_frame_;
  std::chrono::duration<double> stale_after_;
  Clock::time_point latest_ = Clock::now();
  std::vector<rclcpp::Subscription<Pose>::SharedPtr> poses_;
  rclcpp::Publisher<WrenchStamped>::SharedPtr wrench_;
  rclcpp::Publisher<ForceWithCovarianceStamped>::SharedPtr force_;
  rclcpp::Publisher<DiagnosticArray>::SharedPtr diagnostics_;
  rclcpp::TimerBase::SharedPtr watchdog_;
};

}  // namespace palpate_ros2

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  int exit_code = 0;
  try {
    rclcpp::spin(std::make_shared<palpate_ros2::Bridge>());
  } catch (const std::exception& error) {
    RCLCPP_FATAL(rclcpp::get_logger("palpate_bridge"), "%s", error.what());
    exit_code = 2;
  }
  rclcpp::shutdown();
  return exit_code;
}
