// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <palpate/math/errors.hpp>
#include <palpate/observer/force_observer.hpp>

#include "arrays.hpp"
#include "bindings.hpp"
#include "frame_arguments.hpp"

namespace palpate::python {
namespace {

/// An estimate, and of how many readings it was made.
struct LiveEstimate : Estimate {
  std::size_t readings = 0;
};

/// A ForceObserver that knows what its frames must bring.
class LiveObserver {
 public:
  LiveObserver(const CatheterFile& file, const py::dict& options)
      : catheter_(file.catheter), options_(with(file.observer, options)), observer_(catheter_, options_) {}

  LiveEstimate update_frame(const TrackerFrame& frame) {
    require_readings(catheter_, frame.readings.size(), "frame");
    return {observer_.update(frame), frame.readings.size()};
  }

  LiveEstimate update(const py::object& time_s, const py::object& position_m, const py::object& quaternion_wxyz,
                      const py::object& tendon_moment_Nm, const py::object& tendon_sigma_Nm) {
    const SensorArrays points(position_m, py::none(), kAnyLength);
    require_readings(catheter_, static_cast<std::size_t>(points.rows()), "position_m");
    const SensorArrays arrays(position_m, quaternion_wxyz, points.rows());
    TrackerFrame frame{.time_s = number(time_s, "time_s", Values::kAny), .number = next_};
    for (py::ssize_t i = 0; i < arrays.rows(); ++i) frame.readings.push_back(arrays.reading(i));
    if (!tendon_moment_Nm.is_none()) frame.tendon = tendon(tendon_moment_Nm, tendon_sigma_Nm);
    ++next_;
    return update_frame(frame);
  }

  py::tuple forecast(const py::object& ahead_s) const {
    const double seconds = number(ahead_s, "ahead_s");
    if (!(seconds >= 0.0 && seconds <= 60.0))
      throw InputError(fmt::format("ahead_s = {}: expected seconds, 0 to 60", seconds));
    const ForceGaussian force = observer_.forecast(seconds);
    return py::make_tuple(force.mean_N, force.covariance_N2);
  }

  py::dict options() const { return as_dict(options_); }

 private:
  static ObserverOptions with(ObserverOptions options, const py::dict& changes) {
    set_options(changes, options);
    return options;
  }
  TendonReading tendon(const py::object& moment_Nm, const py::object& sigma_Nm) const {
    if (!catheter_.tendon.present)
      throw InputError("tendon_moment_Nm: expected None, for the catheter has no [tendon]");
    const Eigen::Vector2d moment = vector2(moment_Nm, "tendon_moment_Nm");
    double sigma = catheter_.tendon.moment_sigma_fraction * moment.norm();
    if (!sigma_Nm.is_none()) sigma = number(sigma_Nm, "tendon_sigma_Nm");
    if (!(sigma >= 0.0)) throw InputError(fmt::format("tendon_sigma_Nm = {}: expected 0 or more", sigma));
    return {.present = true, .moment_Nm = moment, .sigma_Nm = sigma};
  }

  Catheter catheter_;
  ObserverOptions options_;
  ForceObserver observer_;
  std::int64_t next_ = 0;
};

py::dict budget_of(const LiveEstimate& estimate) {
  py::dict out;
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    out[py::str(std::string(describe(static_cast<UncertaintySource>(i))))] = estimate.sigma_by_source_N[i];
  return out;
}

py::list rejections_of(const LiveEstimate& estimate) {
  py::list out;
  for (std::size_t i = 0; i < estimate.readings; ++i) out.append(std::string(describe(estimate.rejections[i])));
  return out;
}

void bind_observability(py::module_& m) {
  using O = Observability;
  py::class_<O>(m, "Observability",
                "What one frame alone tells, all else being uncertain as the catheter file says; str() says it in "
                "words.\n\nweakest_force_N (3,): direction that it tells least, one prior sigma long; weakest_sigmas: "
                "sigma along it, in prior sigmas. Source: palpate/observer/observability.hpp.")
      .def_readonly("weakest_force_N", &O::weakest_force_N)
      .def_readonly("weakest_sigmas", &O::weakest_sigmas)
      .def_readonly("axial_force_hidden", &O::axial_force_hidden)
      .def_readonly("lateral_force_hidden", &O::lateral_force_hidden)
      .def_readonly("shaft_straight", &O::shaft_straight)
      .def_readonly("stiffness_rests_on_prior", &O::stiffness_rests_on_prior)
      .def_readonly("precurvature_rests_on_prior", &O::precurvature_rests_on_prior)
      .def_property_readonly("all_observable", &O::all_observable)
      .def("__str__", [](const O& o) { return describe(o); });
}

void bind_estimate(py::module_& m) {
  using E = LiveEstimate;
  py::class_<E>(
      m, "Estimate",
      "What the observer knows after a frame. Arrays are views, read-only.\n\n"
      "status             UPDATED, RESEEDED, AMBIGUOUS, REJECTED, HELD, NOT_CONVERGED (palpate/observer/estimate.hpp)\n"
      "force_tip_N        (3,) of the tissue on the tip, along d1, d2, d3 at the flexible end\n"
      "covariance_tip_N2  (3, 3) of all that is not known exactly, not of the noise alone; sigma_tip_N (3,)\n"
      "sigma_by_source_N  (3,) each: what it is made of\n"
      "force_base_N       (3,) the same force in the clamp's frame; R_base_tip (3, 3) turns one into the other\n"
      "stiffness_Nm2, precurvature_per_m  (3,) estimated or as stated, with their sigmas\n"
      "observability      what this frame could not tell\n"
      "nis, dof           normalised innovation squared and its degrees of freedom; 0 where nothing was used\n"
      "rejections         a word for each reading: none, missing, not finite, outlier, ...\n\n"
      "HELD and REJECTED carry the predicted force with its grown covariance.")
      .def_readonly("time_s", &E::time_s)
      .def_property_readonly("status", [](const E& e) { return std::string(describe(e.status)); })
      .def_readonly("force_tip_N", &E::force_tip_N)
      .def_readonly("covariance_tip_N2", &E::covariance_tip_N2)
      .def_property_readonly("sigma_tip_N",
                             [](const E& e) { return Vector3d(e.covariance_tip_N2.diagonal().cwiseSqrt()); })
      .def_readonly("force_base_N", &E::force_base_N)
      .def_readonly("R_base_tip", &E::R_base_tip)
      .def_property_readonly("sigma_by_source_N", &budget_of)
      .def_readonly("observability", &E::observability)
      .def_property_readonly("stiffness_Nm2", [](const E& e) { return e.shaft.stiffness_Nm2; })
      .def_property_readonly("stiffness_sigma_Nm2", [](const E& e) { return e.shaft.stiffness_sigma_Nm2; })
      .def_property_readonly("precurvature_per_m", [](const E& e) { return e.shaft.precurvature_per_m; })
      .def_property_readonly("precurvature_sigma_per_m", [](const E& e) { return e.shaft.precurvature_sigma_per_m; })
      .def_readonly("sensors_used", &E::sensors_used)
      .def_readonly("nis", &E::nis)
      .def_readonly("dof", &E::dof)
      .def_readonly("jumped", &E::jumped)
      .def_readonly("evaluations", &E::evaluations)
      .def_property_readonly("rejections", &rejections_of)
      .def("__repr__", [](const E& e) {
        const Vector3d& f = e.force_tip_N;
        return fmt::format("Estimate(time_s={:g}, {}, force_tip_N=[{:.4f}, {:.4f}, {:.4f}])", e.time_s,
                           describe(e.status), f.x(), f.y(), f.z());
      });
}

}  // namespace

void bind_observer(py::module_& m) {
  bind_observability(m);
  bind_estimate(m);
  py::class_<LiveObserver>(m, "Observer")
      .def(py::init<const CatheterFile&, const py::dict&>())
      .def("update", &LiveObserver::update)
      .def("update_frame", &LiveObserver::update_frame)
      .def("forecast", &LiveObserver::forecast)
      .def_property_readonly("options", &LiveObserver::options);
}

}  // namespace palpate::python
