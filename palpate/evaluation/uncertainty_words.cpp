// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <palpate/evaluation/uncertainty_words.hpp>
#include <vector>

namespace palpate {
namespace {

std::string budget_words(const SigmaBudget& sigma_N) {
  if (std::all_of(sigma_N.begin(), sigma_N.end(), [](const Vector3d& sigma) { return sigma.isZero(0.0); })) return "";
  std::string text = fmt::format("what makes the sigma (median, mN):    {:>10}{:>10}{:>10}\n", "Fx", "Fy", "Fz");
  for (std::size_t i = 0; i < kUncertaintySources; ++i) {
    const Vector3d mN = sigma_N[i] * 1e3;
    if (!mN.isZero(0.0))
      text += fmt::format("  {:<36}{:>10.3f}{:>10.3f}{:>10.3f}\n", describe(static_cast<UncertaintySource>(i)), mN.x(),
                          mN.y(), mN.z());
  }
  return text;
}

/// A direction without a sense: its largest part is made positive.
Vector3d upright(const Vector3d& direction) {
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  return direction(largest) < 0.0 ? Vector3d(-direction) : direction;
}

/// To two digits, none of them -0.00.
Vector3d rounded(const Vector3d& v) { return (100.0 * v).array().round() / 100.0 + 0.0; }

/// "d3 (0.02, 0.01, 1.00)": an axis is named where the direction lies within some 25 degrees of it.
std::string axis_and_direction(const Vector3d& along) {
  const Vector3d unit = rounded(upright(along.normalized()));
  Eigen::Index axis = 0;
  const double nearest = unit.maxCoeff(&axis);
  const std::string name = nearest > 0.9 ? fmt::format("d{} ", axis + 1) : "";
  return fmt::format("{}({:.2f}, {:.2f}, {:.2f})", name, unit.x(), unit.y(), unit.z());
}

/// Force alone is a direction; mixed with parameters it is what each of them would be off by, one prior sigma together.
std::string direction_words(const WeakestDirection& weakest) {
  const Vector3d &f = weakest.force_N, &EI = weakest.log_stiffness, &k = weakest.precurvature_per_m;
  if (EI.isZero(0.0) && k.isZero(0.0)) return axis_and_direction(f);
  std::vector<std::string> parts;
  if (!f.isZero(0.0)) parts.push_back(fmt::format("force ({:.3f}, {:.3f}, {:.3f}) N", f.x(), f.y(), f.z()));
  if (!EI.isZero(0.0))
    parts.push_back(fmt::format("stiffness ({:.1f}, {:.1f}, {:.1f}) %", 100 * EI.x(), 100 * EI.y(), 100 * EI.z()));
  if (!k.isZero(0.0)) parts.push_back(fmt::format("precurvature ({:.2f}, {:.2f}) 1/m", k.x(), k.y()));
  return fmt::format("{}", fmt::join(parts, " with "));
}

std::string weakest_words(const WeakestDirection& weakest) {
  if (!(weakest.prior_sigmas > 0.0)) return "";
  if (std::isinf(weakest.prior_sigmas))
    return fmt::format("weakest direction: {}, of which one frame alone says nothing\n", direction_words(weakest));
  return fmt::format("weakest direction: {}, known to {:.2g} prior sigmas by one frame alone\n",
                     direction_words(weakest), weakest.prior_sigmas);
}

std::string hidden_words(const HiddenFrames& hidden, std::size_t frames) {
  std::string text;
  const auto say = [&](const char* how, const char* what, std::size_t count, const char* why) {
    if (count > 0) text += fmt::format("{} observable: {} in {} of {} frames{}\n", how, what, count, frames, why);
  };
  say("not", "axial force", hidden.axial_force_straight, " (shaft is straight)");
  say("hardly", "axial force", hidden.axial_force - hidden.axial_force_straight, "");
  say("not", "lateral force", hidden.lateral_force, "");
  return text;
}

/// Shape carries no newtons: what the size of every force rests on.
std::string scale_words(const UncertaintySummary& s, const ObserverOptions& options) {
  const Observability& o = s.last_observability;
  if (options.estimate_stiffness)
    return fmt::format("stiffness scale: {:.1f} % (prior {:.1f} %){}\n", 100.0 * o.stiffness_scale_sigma,
                       100.0 * o.stiffness_scale_prior_sigma, o.stiffness_rests_on_prior ? ": rests on the prior" : "");
  const double sigma = s.last_shaft.stiffness_sigma_Nm2.x() / s.last_shaft.stiffness_Nm2.x();
  if (options.consider_uncertainty && sigma > 0.0)
    return fmt::format("stiffness scale: the catheter file's, known to {:.1f} %\n", 100.0 * sigma);
  return "stiffness scale: the catheter file's, taken as exact\n";
}

std::string shaft_words(const UncertaintySummary& s, const ObserverOptions& options) {
  const ShaftEstimate& shaft = s.last_shaft;
  std::vector<std::string> parts;
  const auto add = [&](const char* name, const Vector3d& value, const Vector3d& sigma, int i, const char* unit) {
    parts.push_back(fmt::format("{} = {:.4g} +- {:.2g} {}", name, value(i), sigma(i), unit));
  };
  if (options.estimate_stiffness) {
    add("EI1", shaft.stiffness_Nm2, shaft.stiffness_sigma_Nm2, 0, "N m^2");
    add("EI2", shaft.stiffness_Nm2, shaft.stiffness_sigma_Nm2, 1, "N m^2");
    if (options.free_torsion) add("GJ", shaft.stiffness_Nm2, shaft.stiffness_sigma_Nm2, 2, "N m^2");
  }
  if (options.estimate_precurvature) {
    add("k1,0", shaft.precurvature_per_m, shaft.precurvature_sigma_per_m, 0, "1/m");
    add("k2,0", shaft.precurvature_per_m, shaft.precurvature_sigma_per_m, 1, "1/m");
  }
  std::string text;
  if (options.estimate_precurvature && s.last_observability.precurvature_rests_on_prior)
    text = "precurvature: rests on the prior\n";
  return parts.empty() ? text : text + fmt::format("{} (last frame)\n", fmt::join(parts, "; "));
}

std::string consider_words(const ObserverOptions& options) {
  if (options.consider_uncertainty) return "";
  if (options.estimate_stiffness || options.estimate_precurvature)
    return "sigma is of noise and of what is estimated: what else the catheter file calls uncertain is left out\n";
  return "sigma is of noise alone: what the catheter file calls uncertain is left out\n";
}

std::string ellipsoid_words(const Matrix3d& covariance_N2) {
  const ForceEllipsoid region = force_ellipsoid(covariance_N2);
  return fmt::format("95 % ellipsoid of the last frame: semi-axes {:.4f}, {:.4f}, {:.4f} N, the longest along {}\n",
                     region.semi_axes_N.x(), region.semi_axes_N.y(), region.semi_axes_N.z(),
                     axis_and_direction(region.axes.col(0)));
}

}  // namespace

std::string in_words(const UncertaintySummary& summary, const ObserverOptions& options) {
  if (summary.frames_used == 0) return "";
  return consider_words(options) + budget_words(summary.median_sigma_by_source_N) + weakest_words(summary.weakest) +
         hidden_words(summary.hidden, summary.frames_used) + scale_words(summary, options) +
         shaft_words(summary, options) + ellipsoid_words(summary.last_covariance_tip_N2);
}

}  // namespace palpate
