// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <palpate/identification/smooth_branch.hpp>
#include <palpate/identification/tendon_map.hpp>
#include <palpate/math/errors.hpp>
#include <set>

namespace palpate {

namespace {

using Eigen::Vector2d;

constexpr int kMostKnots = 16;

std::vector<HandleSample> of_branch(std::span<const HandleSample> samples, bool release) {
  std::vector<HandleSample> out;
  for (const HandleSample& sample : samples)
    if (sample.release == release) out.push_back(sample);
  return out;
}

void check(std::span<const HandleSample> samples) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (!std::isfinite(samples[i].position) || !samples[i].precurvature_per_m.allFinite() ||
        !(samples[i].sigma_per_m.array() >= 0.0).all())
      throw InputError(fmt::format("handle sample {}: expected finite numbers, sigmas of 0 or more", i + 1));
}

/// Not more than the samples of either branch can hold.
int knots_for(const std::vector<HandleSample>& branch, const char* name) {
  std::set<double> positions;
  for (const HandleSample& sample : branch) positions.insert(sample.position);
  const std::size_t n = std::min(positions.size(), branch.size());
  if (n < 3) throw InputError(fmt::format("{} branch: {} positions of the handle: expected three or more", name, n));
  return std::clamp(static_cast<int>(2 * n / 3), 2, kMostKnots);
}

std::vector<double> equal_steps(std::span<const HandleSample> samples, int count) {
  const auto [least, most] = std::minmax_element(samples.begin(), samples.end(),
                                                 [](const auto& a, const auto& b) { return a.position < b.position; });
  std::vector<double> knots;
  knots.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    knots.push_back(least->position + (most->position - least->position) * i / (count - 1));
  return knots;
}

/// Neighbours that fall where they should rise are given their mean (pool adjacent violators).
Eigen::VectorXd pooled(const Eigen::VectorXd& values, double sense) {
  struct Pool {
    double sum;
    int count;
    double mean() const { return sum / count; }
  };
  std::vector<Pool> pools;
  for (const double value : values) {
    pools.push_back({sense * value, 1});
    while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
      pools[pools.size() - 2] = {pools[pools.size() - 2].sum + pools.back().sum,
                                 pools[pools.size() - 2].count + pools.back().count};
      pools.pop_back();
    }
  }
  Eigen::VectorXd out(values.size());
  Eigen::Index at = 0;
  for (const Pool& pool : pools)
    for (int i = 0; i < pool.count; ++i) out(at++) = sense * pool.mean();
  return out;
}

/// Both branches of one axis.
struct Axis {
  SmoothBranch pull, release;
  double rss = 0.0, freedom = 0.0;
  double scatter() const { return freedom > 0.0 ? std::sqrt(rss / freedom) : 0.0; }
};

Axis fit_axis(const std::vector<HandleSample>& pulls, const std::vector<HandleSample>& releases, int axis,
              const std::vector<double>& knots) {
  const auto fit = [&](const std::vector<HandleSample>& branch) {
    std::vector<double> x, y;
    for (const HandleSample& sample : branch) {
      x.push_back(sample.position);
      y.push_back(sample.precurvature_per_m(axis));
    }
    return smooth_branch(x, y, knots);
  };
  Axis out{.pull = fit(pulls), .release = {}};
  out.release = releases.empty() ? out.pull : fit(releases);
  out.rss = out.pull.rss;
  out.freedom = static_cast<double>(pulls.size()) - out.pull.effective_parameters;
  if (!releases.empty()) {
    out.rss += out.release.rss;
    out.freedom += static_cast<double>(releases.size()) - out.release.effective_parameters;
  }
  return out;
}

/// What the shaft itself scatters, and what all samples are off together: [1/m]^2.
double lasting_variance(std::span<const HandleSample> samples, int axis, double scatter, bool common_error) {
  double stated = 0.0;
  for (const HandleSample& sample : samples)
    stated += sample.sigma_per_m(axis) * sample.sigma_per_m(axis) / static_cast<double>(samples.size());
  const double seen = scatter * scatter;
  return common_error ? seen + stated : std::max(seen - stated, 0.0);
}

void order_branches(Axis& k1, double sense, std::vector<std::string>& warnings) {
  const double sigma = 3.0 * k1.scatter();
  for (SmoothBranch* branch : {&k1.pull, &k1.release}) {
    const Eigen::VectorXd rising = pooled(branch->value, sense);
    if ((rising - branch->value).cwiseAbs().maxCoeff() > std::max(sigma, 1e-6))
      warnings.emplace_back("k1,0 does not only rise, or only fall, with the position: it was made to");
    branch->value = rising;
  }
  const Eigen::VectorXd width = sense * (k1.release.value - k1.pull.value);
  if (width.mean() < -std::max(k1.scatter(), 1e-6))
    throw InputError(
        fmt::format("the release branch is less bent than the pull branch, by {:.3g} 1/m on average: expected the more "
                    "bent one, for friction holds what was pulled; are the directions exchanged?",
                    -width.mean()));
  const Eigen::VectorXd middle = 0.5 * (k1.pull.value + k1.release.value);
  for (Eigen::Index i = 0; i < width.size(); ++i)
    if (width(i) < 0.0) k1.pull.value(i) = k1.release.value(i) = middle(i);
}

void describe_hysteresis(double sense, TendonMapFit& out) {
  const TendonMap& map = out.map;
  const std::size_t n = map.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double width = sense * (map.release_per_m[i].x() - map.pull_per_m[i].x());
    out.mean_width_per_m += width / static_cast<double>(n);
    out.largest_width_per_m = std::max(out.largest_width_per_m, width);
  }
  const double rise = std::abs(map.pull_per_m.back().x() - map.pull_per_m.front().x());
  if (rise > 0.0) out.dead_zone = out.mean_width_per_m * (map.position.back() - map.position.front()) / rise;
}

void take_branches(const Axis (&axes)[2], const Vector2d& lasting, TendonMapFit& out) {
  Vector2d of_curve = Vector2d::Zero();
  const auto n = static_cast<Eigen::Index>(out.map.position.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    Vector2d pull_variance, release_variance;
    for (int axis = 0; axis < 2; ++axis) {
      const double s2 = axes[axis].scatter() * axes[axis].scatter();
      pull_variance(axis) = s2 * axes[axis].pull.variance(i);
      release_variance(axis) = s2 * axes[axis].release.variance(i);
    }
    of_curve += 0.5 * (pull_variance + release_variance) / static_cast<double>(n);
    out.map.pull_per_m.emplace_back(axes[0].pull.value(i), axes[1].pull.value(i));
    out.map.release_per_m.emplace_back(axes[0].release.value(i), axes[1].release.value(i));
    out.pull_sigma_per_m.emplace_back((lasting + pull_variance).cwiseSqrt());
    out.release_sigma_per_m.emplace_back((lasting + release_variance).cwiseSqrt());
  }
  constexpr double kLeastSigma_per_m = 1e-6;  // of perfect samples: the map still wants one
  out.map.sigma_per_m = (lasting + of_curve).cwiseSqrt().cwiseMax(kLeastSigma_per_m);
}

}  // namespace

TendonMapFit fit_tendon_map(std::span<const HandleSample> samples, TendonInput input, bool common_error) {
  check(samples);
  const std::vector<HandleSample> pulls = of_branch(samples, false), releases = of_branch(samples, true);
  int knots = knots_for(pulls, "pull");
  if (!releases.empty()) knots = std::min(knots, knots_for(releases, "release"));
  TendonMapFit out;
  out.pulls = static_cast<int>(pulls.size());
  out.releases = static_cast<int>(releases.size());
  out.map.present = true;
  out.map.input = input;
  out.map.position = equal_steps(samples, knots);
  Axis axes[2] = {fit_axis(pulls, releases, 0, out.map.position), fit_axis(pulls, releases, 1, out.map.position)};
  const Eigen::VectorXd both = axes[0].pull.value + axes[0].release.value;
  const double sense = both(knots - 1) < both(0) ? -1.0 : 1.0;
  out.scatter_per_m = {axes[0].scatter(), axes[1].scatter()};
  out.degrees_of_freedom = axes[0].freedom;
  order_branches(axes[0], sense, out.warnings);
  if (releases.empty())
    out.warnings.emplace_back(
        "no sample of the release branch: the map has no hysteresis, and its sigma knows of none");
  Vector2d lasting;
  for (int axis = 0; axis < 2; ++axis)
    lasting(axis) = lasting_variance(samples, axis, out.scatter_per_m(axis), common_error);
  take_branches(axes, lasting, out);
  describe_hysteresis(sense, out);
  const TendonPlay play(out.map, Vector2d::Zero());
  out.residual_per_m.reserve(samples.size());
  for (const HandleSample& sample : samples)
    out.residual_per_m.emplace_back(sample.precurvature_per_m - (sample.release ? play.release_per_m(sample.position)
                                                                                : play.pull_per_m(sample.position)));
  out.map.validate();
  return out;
}

}  // namespace palpate
