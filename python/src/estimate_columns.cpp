// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"
#include "bindings.hpp"

namespace palpate::python {
namespace {

/// Columns of equal length, each filled estimate by estimate.
class Columns {
 public:
  explicit Columns(std::span<const Estimate> estimates) : estimates_(estimates) {}

  template <class Get>
  void numbers(const char* name, const Get& get) {
    out_[name] = filled(estimates_.size(), {}, [&](std::size_t i, double* to) { *to = get(estimates_[i]); });
  }
  template <class Get>
  void counts(const char* name, const Get& get) {
    out_[name] = filled<std::int32_t>(estimates_.size(), {}, [&](std::size_t i, std::int32_t* to) {
      *to = static_cast<std::int32_t>(get(estimates_[i]));
    });
  }
  template <class Get>
  void vectors(const char* name, const Get& get) {
    out_[name] = filled(estimates_.size(), {3}, [&](std::size_t i, double* to) { put_rows(get(estimates_[i]), to); });
  }
  template <class Get>
  void matrices(const char* name, const Get& get) {
    out_[name] =
        filled(estimates_.size(), {3, 3}, [&](std::size_t i, double* to) { put_rows(get(estimates_[i]), to); });
  }
  void budget(const char* name) {
    const auto rows = static_cast<py::ssize_t>(kUncertaintySources);
    out_[name] = filled(estimates_.size(), {rows, 3}, [&](std::size_t i, double* to) {
      for (const Vector3d& sigma_N : estimates_[i].sigma_by_source_N) {
        put_rows(sigma_N, to);
        to += 3;
      }
    });
  }
  py::dict take() { return std::move(out_); }

 private:
  std::span<const Estimate> estimates_;
  py::dict out_;
};

}  // namespace

py::dict estimate_columns(std::span<const Estimate> estimates) {
  Columns columns(estimates);
  columns.numbers("time_s", [](const Estimate& e) { return e.time_s; });
  columns.vectors("force_tip_N", [](const Estimate& e) { return e.force_tip_N; });
  columns.matrices("covariance_tip_N2", [](const Estimate& e) { return e.covariance_tip_N2; });
  columns.vectors("force_base_N", [](const Estimate& e) { return e.force_base_N; });
  columns.matrices("R_base_tip", [](const Estimate& e) { return e.R_base_tip; });
  columns.counts("status", [](const Estimate& e) { return e.status; });
  columns.counts("sensors_used", [](const Estimate& e) { return e.sensors_used; });
  columns.numbers("nis", [](const Estimate& e) { return e.nis; });
  columns.counts("dof", [](const Estimate& e) { return e.dof; });
  columns.counts("evaluations", [](const Estimate& e) { return e.evaluations; });
  columns.vectors("stiffness_Nm2", [](const Estimate& e) { return e.shaft.stiffness_Nm2; });
  columns.vectors("stiffness_sigma_Nm2", [](const Estimate& e) { return e.shaft.stiffness_sigma_Nm2; });
  columns.vectors("precurvature_per_m", [](const Estimate& e) { return e.shaft.precurvature_per_m; });
  columns.vectors("precurvature_sigma_per_m", [](const Estimate& e) { return e.shaft.precurvature_sigma_per_m; });
  columns.budget("sigma_by_source_N");
  columns.vectors("forecast_tip_N", [](const Estimate& e) { return e.forecast.mean_N; });
  columns.matrices("forecast_covariance_N2", [](const Estimate& e) { return e.forecast.covariance_N2; });
  return columns.take();
}

}  // namespace palpate::python
