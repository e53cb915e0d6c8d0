// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <palpate/identification/delay_comparison.hpp>
#include <palpate/math/errors.hpp>

namespace palpate {

namespace {

constexpr double kLeastExplained = 0.1;
constexpr double kRivalShare = 0.9;     // of what the best delay explains
constexpr double kRivalChiSquare = 25;  // what separates the best from its rival: five sigmas

using Scan = std::vector<Overlay>;

bool is_minimum(const Scan& scan, std::size_t i) {
  return i > 0 && i + 1 < scan.size() && scan[i].cost <= scan[i - 1].cost && scan[i].cost <= scan[i + 1].cost;
}

void refuse_unlike(const Overlay& best) {
  if (best.explained() >= kLeastExplained) return;
  const bool flat = best.sensor_power < best.unexplained;
  throw InputError(
      flat ? fmt::format("the force does not change: a delay cannot be told; the force sensor's varies by {:.2g} times "
                         "the scatter of the tracker's",
                         best.unexplained > 0.0 ? std::sqrt(best.sensor_power / best.unexplained) : 0.0)
           : fmt::format("the two forces are not alike at any delay: the force sensor's explains {:.0f} % of the "
                         "tracker's: expected at least {:.0f} %; are both of one run, in tip axes, of one sign?",
                         100.0 * std::max(0.0, best.explained()), 100.0 * kLeastExplained));
}

/// The best minimum outside the valley of the best one: the cost must rise between the two.
std::optional<std::size_t> find_rival(const Scan& scan, std::size_t best) {
  std::size_t from = best, to = best;
  while (from > 0 && scan[from - 1].cost >= scan[from].cost) --from;
  while (to + 1 < scan.size() && scan[to + 1].cost >= scan[to].cost) ++to;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (i >= from && i <= to) continue;
    const bool edge = i == 0 || i + 1 == scan.size();
    if ((edge || is_minimum(scan, i)) && std::isfinite(scan[i].cost) && (!found || scan[i].cost < scan[*found].cost))
      found = i;
  }
  return found;
}

double refine(const DelayComparison& comparison, double from_s, double to_s) {
  const auto cost = [&](double delay_s) { return comparison.overlay(delay_s).cost; };
  return boost::math::tools::brent_find_minima(cost, from_s, to_s, 24).first;
}

/// How far the costs of two delays are apart, as a chi-square of what is independent in the residuals.
double separation(const Overlay& best, const Overlay& rival, const DelayFit& fit) {
  const double independent = 3.0 * (fit.times_s.back() - fit.times_s.front()) / fit.correlation_time_s;
  return independent * (rival.cost - best.cost) / (best.cost + 1e-6 * best.unexplained);
}

DelayFit finished(const DelayComparison& comparison, DelayFit fit, double delay_s) {
  fit.delay_s = delay_s;
  comparison.finish(fit);
  return fit;
}

/// Looks at the next best delay, too. Where noise may have chosen between the two, it is the smaller shift.
DelayFit choose(const DelayComparison& comparison, const DelayFit& scanned, const Scan& scan, std::size_t best) {
  const auto& delays_s = scanned.scan_delay_s;
  DelayFit fit = finished(comparison, scanned, refine(comparison, delays_s[best - 1], delays_s[best + 1]));
  const std::optional<std::size_t> at = find_rival(scan, best);
  if (!at) return fit;
  const bool edge = *at == 0 || *at + 1 == scan.size();
  const double other_s = edge ? delays_s[*at] : refine(comparison, delays_s[*at - 1], delays_s[*at + 1]);
  const Overlay here = comparison.overlay(fit.delay_s), there = comparison.overlay(other_s);
  fit.rival = DelayFit::Rival{other_s, there.explained()};
  const bool by_chance = separation(here, there, fit) < kRivalChiSquare;
  fit.ambiguous = by_chance || there.explained() > kRivalShare * fit.explained;
  if (!by_chance || edge || std::abs(other_s) >= std::abs(fit.delay_s)) return fit;
  DelayFit smaller = finished(comparison, scanned, other_s);
  smaller.rival = DelayFit::Rival{fit.delay_s, fit.explained};
  smaller.ambiguous = true;
  return smaller;
}

}  // namespace

DelayFit identify_delay(std::span<const TimedForce> tracker, std::span<const TimedForce> sensor,
                        const DelayOptions& options) {
  if (!(options.max_delay_s > 0.0))
    throw InputError(fmt::format("max_delay_s = {}: expected > 0", options.max_delay_s));
  if (tracker.empty()) throw InputError("the tracker tells no force: expected usable frames");
  if (sensor.size() < 2) throw InputError("the force sensor has one sample: expected a trace");
  const DelayComparison comparison(tracker, sensor, options);
  DelayFit fit;
  Scan scan;
  const auto half = static_cast<int>(std::ceil(options.max_delay_s / comparison.scan_step_s()));
  for (int i = -half; i <= half; ++i) {
    fit.scan_delay_s.push_back(options.max_delay_s * i / half);
    scan.push_back(comparison.overlay(fit.scan_delay_s.back()));
    fit.scan_explained.push_back(scan.back().explained());
  }
  const auto least = std::min_element(scan.begin(), scan.end(),
                                      [](const Overlay& a, const Overlay& b) { return a.explained() > b.explained(); });
  refuse_unlike(*least);
  const auto best = static_cast<std::size_t>(least - scan.begin());
  if (best == 0 || best + 1 == scan.size())
    throw InputError(
        fmt::format("the best delay lies at the edge of the range, {:+.3g} s: expected one inside it; try "
                    "a larger --max-delay",
                    fit.scan_delay_s[best]));
  fit = choose(comparison, fit, scan, best);
  if (!(fit.sigma_s < options.max_delay_s))
    throw InputError("the force changes too evenly: a shift in time looks like an offset, a delay cannot be told");
  return fit;
}

}  // namespace palpate
