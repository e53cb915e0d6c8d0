// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <palpate/recording/budget_csv.hpp>

namespace palpate {

BudgetCsvWriter::BudgetCsvWriter(const std::filesystem::path& path) : file_(path) {
  file_.write("time_s,not_observable,weakest_fx_N,weakest_fy_N,weakest_fz_N,weakest_sigmas");
  for (std::size_t i = 0; i < kUncertaintySources; ++i)
    file_.write(fmt::format(",sigma_{0}_x_N,sigma_{0}_y_N,sigma_{0}_z_N", describe(static_cast<UncertaintySource>(i))));
  file_.write("\n");
}

void BudgetCsvWriter::write(const Estimate& e) {
  const Observability& o = e.observability;
  const Vector3d& weakest = o.weakest_force_N;
  file_.write(fmt::format("{},{},{:.9g},{:.9g},{:.9g},{:.9g}", e.time_s, o.all_observable() ? "" : describe(o),
                          weakest.x(), weakest.y(), weakest.z(), o.weakest_sigmas));
  for (const Vector3d& sigma : e.sigma_by_source_N)
    file_.write(fmt::format(",{:.9g},{:.9g},{:.9g}", sigma.x(), sigma.y(), sigma.z()));
  file_.write("\n");
}

}  // namespace palpate
