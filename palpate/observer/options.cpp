// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/math/errors.hpp>
#include <palpate/observer/options.hpp>

namespace palpate {
namespace {

void require(bool good, const char* field, double value, const char* range) {
  if (good) return;
  throw InputError(fmt::format("observer options: {} = {}: expected {}", field, value, range));
}

}  // namespace

void ObserverOptions::validate() const {
  if (method == Method::kUkf) throw InputError("observer options: method = kUkf: expected kEkf, kIekf or kIaekf");
  if (force_model > ForceModel::kGaussMarkov)
    throw InputError("observer options: force_model: expected kRandomWalk or kGaussMarkov");
  require(force_rate_N_per_sqrt_s > 0.0 && force_rate_N_per_sqrt_s <= 100.0, "force_rate_N_per_sqrt_s",
          force_rate_N_per_sqrt_s, "more than 0, at most 100");
  require(force_memory_s >= 1e-3 && force_memory_s <= 1e4, "force_memory_s", force_memory_s, "0.001..10000");
  require(initial_force_sigma_N > 0.0 && initial_force_sigma_N <= 1000.0, "initial_force_sigma_N",
          initial_force_sigma_N, "more than 0, at most 1000");
  require(max_iterations >= 1 && max_iterations <= 100, "max_iterations", max_iterations, "1..100");
  require(adaptation_window >= 5 && adaptation_window <= 1000, "adaptation_window", adaptation_window, "5..1000");
  require(outlier_probability > 0.0 && outlier_probability <= 0.1, "outlier_probability", outlier_probability,
          "more than 0, at most 0.1");
}

}  // namespace palpate
