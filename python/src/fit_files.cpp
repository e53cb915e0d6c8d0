// SPDX-License-Identifier: Apache-2.0
#include "fit_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <apps/palpate/file_paths.hpp>
#include <cmath>
#include <palpate/math/errors.hpp>

#include "arrays.hpp"

namespace palpate::python {
namespace {

/// Collects what differs, by the names of a catheter file; numbers count as alike to what a file's text keeps of them.
class Differences {
 public:
  Differences(const Fitted& fitted, const Catheter& stated) : fitted_(fitted), a_(fitted.catheter), b_(stated) {
    compare_sections();
    compare_shaft();
    if (a_.sensors.size() == b_.sensors.size())
      for (std::size_t i = 0; i < a_.sensors.size(); ++i) compare_sensor(a_.sensors[i], b_.sensors[i], false);
    else
      found_.emplace_back("number of sensors");
    compare_base();
  }
  const std::vector<std::string>& found() const { return found_; }

 private:
  static bool alike(double x, double y) { return std::abs(x - y) <= 1e-9 * std::max({1e-3, std::abs(x), std::abs(y)}); }
  template <class X, class Y>
  static bool alike(const Eigen::MatrixBase<X>& x, const Eigen::MatrixBase<Y>& y) {
    return (x - y).norm() <= 1e-9 * std::max({1e-3, x.norm(), y.norm()});
  }
  static bool alike(const Pose& x, const Pose& y) { return alike(x.R, y.R) && alike(x.p, y.p); }
  void compare(const std::string& what, bool same) {
    if (!same) found_.push_back(what);
  }

  void compare_sections() {
    const auto& a = a_.rod.sections;
    const auto& b = b_.rod.sections;
    const auto all = [&](auto same) { return std::equal(a.begin(), a.end(), b.begin(), b.end(), same); };
    const bool same = all([](const Section& x, const Section& y) {
      return alike(x.from_m, y.from_m) && alike(x.to_m, y.to_m) && x.rigid == y.rigid;
    });
    compare(a.size() == 1 && b.size() == 1 ? "length_mm" : "sections", same);
    if (!same) return;
    compare("precurvature_per_m",
            all([](const Section& x, const Section& y) { return alike(x.precurvature_per_m, y.precurvature_per_m); }));
    if (!fitted_.stiffness && !a_.rod.has_distributed_load()) return;
    compare("stiffness", all([](const Section& x, const Section& y) {
              return x.rigid || (x.stiffness_Nm2 - y.stiffness_Nm2).norm() <= 1e-9 * x.stiffness_Nm2.norm();
            }));
  }

  void compare_shaft() {
    const Rod &a = a_.rod, &b = b_.rod;
    compare("rigid_tip_mm", alike(a.rigid_tip_m, b.rigid_tip_m));
    compare("contact_offset_mm", alike(a.contact_offset_m, b.contact_offset_m));
    compare("shear_stiffness_N", alike(a.shear_stiffness_N, b.shear_stiffness_N));
    compare("axial_stiffness_N", alike(a.axial_stiffness_N, b.axial_stiffness_N));
    compare("weight_N_per_m or its direction", alike(a.distributed_load_base_N_per_m, b.distributed_load_base_N_per_m));
    compare("precurvature_sigma_per_m", alike(a_.precurvature_sigma_per_m, b_.precurvature_sigma_per_m));
  }

  /// The mounting of a base sensor is what a registration identifies.
  void compare_sensor(const Sensor& a, const Sensor& b, bool of_base) {
    const auto of = [&](std::string_view what) { return fmt::format("sensor \"{}\": {}", a.name, what); };
    compare(of("name"), a.name == b.name);
    compare(of("kind"), a.kind == b.kind);
    if (!of_base) compare(of("arc_length_mm"), alike(a.arc_length_m, b.arc_length_m));
    if (!fitted_.poses) return;
    if (!of_base || fitted_.base) compare(of("mounting"), alike(a.T_local_sensor, b.T_local_sensor));
    compare(of("mount_sigma_mm"), alike(a.mount_sigma_m, b.mount_sigma_m));
    compare(of("noise"), alike(a.noise_m, b.noise_m) && alike(a.noise_rad, b.noise_rad));
    compare(of("bias"), alike(a.bias_m, b.bias_m) && alike(a.bias_rad, b.bias_rad));
    compare(of("delay_s"), alike(a.delay_s, b.delay_s));
    compare(of("markers"), a.markers == b.markers);
    compare(of("base of its own tracker"), a.T_tracker_base.has_value() == b.T_tracker_base.has_value() &&
                                               (!a.T_tracker_base || alike(*a.T_tracker_base, *b.T_tracker_base)));
  }

  void compare_base() {
    const BaseRegistration &a = a_.base, &b = b_.base;
    compare("base: sensor", a.tracked == b.tracked);
    if (a.tracked && b.tracked) compare_sensor(a.sensor, b.sensor, true);
    if (!fitted_.base) return;
    if (fitted_.poses && !a.tracked) compare("base: pose", alike(a.T_tracker_base, b.T_tracker_base));
    compare("base: sigmas",
            alike(a.position_sigma_m, b.position_sigma_m) && alike(a.rotation_sigma_rad, b.rotation_sigma_rad));
  }

  const Fitted& fitted_;
  const Catheter &a_, &b_;
  std::vector<std::string> found_;
};

/// What was identified would stand at another place.
void refuse_another(const Fitted& fitted, const Catheter& stated, const std::string& path) {
  const Differences differences(fitted, stated);
  if (differences.found().empty()) return;
  throw InputError(fmt::format("{}: {}: expected as of the catheter to which the fit was made", path,
                               fmt::join(differences.found(), ", ")));
}

}  // namespace

FitFiles fit_files(const py::object& catheter, const py::object& out, const Fitted& fitted) {
  FitFiles files{.catheter = path_text(catheter, "catheter"), .out = path_text(out, "out"), .stated = {}};
  app::check_paths({{"out", "the file to write", files.out}}, {});  // which may be empty on a command line
  app::check_paths({{"catheter", "the catheter file", files.catheter}}, {{"out", files.out}});
  files.stated = read_catheter_file(files.catheter);
  refuse_another(fitted, files.stated.catheter, files.catheter);
  return files;
}

}  // namespace palpate::python
