// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <palpate/math/errors.hpp>
#include <palpate/sensing/tendon_map.hpp>
#include <string_view>

namespace palpate {

namespace {

using Eigen::Vector2d;

constexpr double kSlack_per_m = 1e-9;  // rounding of a file's numbers is no crossing of the branches

[[noreturn]] void refuse(std::string_view entry, std::size_t index, double value, std::string_view expectation) {
  throw InputError(fmt::format("tendon_map: {}[{}] = {}: expected {}", entry, index, value, expectation));
}

/// +1 where k1,0 rises with the position, else -1.
double sense_of(const std::vector<Vector2d>& pull, const std::vector<Vector2d>& release) {
  return pull.back().x() - pull.front().x() + release.back().x() - release.front().x() < 0.0 ? -1.0 : 1.0;
}

/// Fritsch and Carlson: no slope steeper than three times the flatter chord beside it, none across a turning point.
double limited(double slope, double before, double behind) {
  if (before * behind <= 0.0) return 0.0;
  const double most = 3.0 * std::min(std::abs(before), std::abs(behind));
  return std::clamp(slope, before > 0.0 ? 0.0 : -most, before > 0.0 ? most : 0.0);
}

}  // namespace

void TendonMap::validate() const {
  if (!present) return;
  const std::size_t n = position.size();
  if (n < 2 || n > kMostPositions || pull_per_m.size() != n || release_per_m.size() != n)
    throw InputError(
        fmt::format("tendon_map: {} positions, {} of the pull branch, {} of the release branch: expected equal "
                    "numbers, 2..{}",
                    n, pull_per_m.size(), release_per_m.size(), kMostPositions));
  const double sense = sense_of(pull_per_m, release_per_m);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(position[i])) refuse("position", i, position[i], "a finite number");
    if (!pull_per_m[i].allFinite()) refuse("pull", i, pull_per_m[i].norm(), "finite numbers");
    if (!release_per_m[i].allFinite()) refuse("release", i, release_per_m[i].norm(), "finite numbers");
    if (sense * (release_per_m[i].x() - pull_per_m[i].x()) < -kSlack_per_m)
      refuse("release_k1_per_m", i, release_per_m[i].x(),
             fmt::format("no less bent than the pull branch, {} 1/m (are the branches exchanged?)", pull_per_m[i].x()));
    if (i == 0) continue;
    if (!(position[i] > position[i - 1])) refuse("position", i, position[i], "more than the one before");
    for (const auto& [name, branch] :
         {std::pair{"pull_k1_per_m", &pull_per_m}, std::pair{"release_k1_per_m", &release_per_m}})
      if (sense * ((*branch)[i].x() - (*branch)[i - 1].x()) < -kSlack_per_m)
        refuse(name, i, (*branch)[i].x(), "a branch that only rises, or only falls");
  }
  if (!(sigma_per_m.x() > 0.0) || !(sigma_per_m.y() >= 0.0) || !sigma_per_m.allFinite())
    refuse("sigma_per_m", 0, sigma_per_m.x(), "more than 0, that of k2,0 0 or more");
}

TendonPlay::TendonPlay(const TendonMap& map, const Vector2d& precurvature_per_m)
    : position_(map.position),
      pull_(make_branch(map.position, map.pull_per_m)),
      release_(make_branch(map.position, map.release_per_m)),
      sigma_per_m_(map.sigma_per_m),
      precurvature_per_m_(precurvature_per_m),
      steepest_(Vector2d::Zero()),
      sense_(sense_of(map.pull_per_m, map.release_per_m)) {
  for (std::size_t i = 1; i < position_.size(); ++i)
    for (const Branch* branch : {&pull_, &release_})
      steepest_ = steepest_.cwiseMax(
          ((branch->value[i] - branch->value[i - 1]) / (position_[i] - position_[i - 1])).cwiseAbs());
}

TendonPlay::Branch TendonPlay::make_branch(const std::vector<double>& position, const std::vector<Vector2d>& value) {
  const std::size_t n = position.size();
  Branch branch{value, std::vector<Vector2d>(n, Vector2d::Zero())};
  const auto chord = [&](std::size_t i) -> Vector2d {
    return (value[i + 1] - value[i]) / (position[i + 1] - position[i]);
  };
  branch.slope.front() = chord(0);
  branch.slope.back() = chord(n - 2);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before_m = position[i] - position[i - 1], behind_m = position[i + 1] - position[i];
    const Vector2d before = chord(i - 1), behind = chord(i);
    const Vector2d parabola = (behind_m * before + before_m * behind) / (before_m + behind_m);
    for (int axis = 0; axis < 2; ++axis) branch.slope[i](axis) = limited(parabola(axis), before(axis), behind(axis));
  }
  return branch;
}

Vector2d TendonPlay::value(const Branch& branch, double position) const {
  if (!(position > position_.front())) return branch.value.front();
  if (position >= position_.back()) return branch.value.back();
  const auto above = std::upper_bound(position_.begin(), position_.end(), position);
  const auto i = static_cast<std::size_t>(above - position_.begin()) - 1;
  const double h = position_[i + 1] - position_[i], t = (position - position_[i]) / h;
  const double t2 = t * t, t3 = t2 * t;
  return (2.0 * t3 - 3.0 * t2 + 1.0) * branch.value[i] + (3.0 * t2 - 2.0 * t3) * branch.value[i + 1] +
         h * ((t3 - 2.0 * t2 + t) * branch.slope[i] + (t3 - t2) * branch.slope[i + 1]);
}

BendReading TendonPlay::advance(double position, Memory& memory) const {
  BendReading out;
  if (!std::isfinite(position)) return out;
  const Vector2d pull = value(pull_, position), release = value(release_, position);
  const double low = sense_ * pull.x(), high = std::max(low, sense_ * release.x());
  if (!memory.started) memory = {.started = true, .least_per_m = low, .most_per_m = high};
  memory.least_per_m = std::clamp(memory.least_per_m, low, high);
  memory.most_per_m = std::clamp(memory.most_per_m, low, high);

  const double middle = 0.5 * (memory.least_per_m + memory.most_per_m), width = high - low;
  const double share = width > kSlack_per_m ? (middle - low) / width : 0.5;
  const double open = width > kSlack_per_m ? (memory.most_per_m - memory.least_per_m) / width : 0.0;
  const Vector2d bend(sense_ * middle, pull.y() + share * (release.y() - pull.y()));
  const double outside = std::max({position_.front() - position, position - position_.back(), 0.0});
  const Vector2d unknown = open / std::sqrt(12.0) * (release - pull).cwiseAbs(), beyond = outside * steepest_;

  out.present = true;
  out.inside = outside == 0.0;
  out.change_per_m = bend - precurvature_per_m_;
  out.sigma_per_m = (sigma_per_m_.cwiseAbs2() + unknown.cwiseAbs2() + beyond.cwiseAbs2()).cwiseSqrt();
  return out;
}

}  // namespace palpate
