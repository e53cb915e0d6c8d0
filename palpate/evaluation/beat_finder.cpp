// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/evaluation/beat_finder.hpp>

namespace palpate {

namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr int kLeastLag = 7, kMostLag = 38;  // of a beat, in bins
static_assert(kLeastLag * BeatFinder::kStep_s <= kSecondsPerMinute / BeatFinder::kMost_per_min);
static_assert(kMostLag * BeatFinder::kStep_s >= kSecondsPerMinute / BeatFinder::kLeast_per_min);

/// What was measured, less its running mean; NaN where nothing was.
template <std::size_t Size>
std::array<double, Size> without_slow_motion(const std::array<double, Size>& values) {
  constexpr std::ptrdiff_t kHalf = 19;  // of the running mean, in bins
  static_assert(2 * kHalf * BeatFinder::kStep_s >= BeatFinder::kSlow_s);
  std::array<double, Size> out;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(Size); ++i) {
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(i - kHalf, 0),
                         to = std::min<std::ptrdiff_t>(i + kHalf + 1, static_cast<std::ptrdiff_t>(Size));
    double sum = 0.0, count = 0.0;
    for (std::ptrdiff_t k = from; k < to; ++k) {
      const double value = values[static_cast<std::size_t>(k)];
      if (std::isnan(value)) continue;
      sum += value;
      count += 1.0;
    }
    out[static_cast<std::size_t>(i)] = values[static_cast<std::size_t>(i)] - sum / count;
  }
  return out;
}

/// sum x_i x_(i+lag) / sqrt(sum x_i^2 sum x_(i+lag)^2), over the pairs of which both were measured.
template <std::size_t Size>
double autocorrelation(const std::array<double, Size>& x, int lag) {
  double product = 0.0, first = 0.0, second = 0.0;
  for (std::size_t i = 0, k = static_cast<std::size_t>(lag); k < Size; ++i, ++k) {
    if (std::isnan(x[i]) || std::isnan(x[k])) continue;
    product += x[i] * x[k];
    first += x[i] * x[i];
    second += x[k] * x[k];
  }
  return first > 0.0 && second > 0.0 ? product / std::sqrt(first * second) : 0.0;
}

}  // namespace

void BeatFinder::add(double time_s, double size_N) {
  if (!(std::isfinite(time_s) && std::isfinite(size_N) && time_s >= 0.0 && time_s < 1e11)) return;
  const auto number = static_cast<std::int64_t>(time_s / kStep_s);
  if (number < newest_) return;
  // What lies between, and what is overwritten, was not measured.
  for (std::int64_t i = std::max(newest_ + 1, number - kBins + 1); i <= number; ++i)
    bins_[static_cast<std::size_t>(i % kBins)] = {};
  newest_ = number;
  Bin& bin = bins_[static_cast<std::size_t>(number % kBins)];
  bin.sum += size_N;
  ++bin.count;
}

std::optional<BeatFinder::Beat> BeatFinder::find() const {
  // The newest bin is not full yet, and is left out.
  std::array<double, kBins - 1> values;
  int measured = 0, pairs = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Bin& bin = bins_[(static_cast<std::size_t>(newest_ + 1) + i) % kBins];
    values[i] = bin.count > 0 ? bin.sum / bin.count : std::nan("");
    measured += bin.count > 0 ? 1 : 0;
    pairs += i > 0 && bin.count > 0 && !std::isnan(values[i - 1]) ? 1 : 0;
  }
  // Of a slow tracker most neighbours are missing, and with them every other lag: a wrong one would win.
  if (newest_ < 0 || measured < kBins / 2 || pairs < 7 * measured / 10) return std::nullopt;
  const auto beating = without_slow_motion(values);
  std::array<double, kMostLag + 2> r{};
  for (int lag = 1; lag <= kMostLag + 1; ++lag) r[static_cast<std::size_t>(lag)] = autocorrelation(beating, lag);
  // What is alike because it has hardly changed yet is no beat: it has to swing through zero first.
  const auto swung = std::find_if(r.begin() + 1, r.end(), [](double value) { return value < 0.0; });
  const auto first = std::max<std::size_t>(kLeastLag, static_cast<std::size_t>(swung - r.begin()));
  if (first > kMostLag) return std::nullopt;
  const double most = *std::max_element(r.begin() + static_cast<std::ptrdiff_t>(first), r.end() - 1);
  for (std::size_t lag = first; lag <= kMostLag; ++lag) {
    // The first peak that is about as high as the highest: those at two or three beats are not taken for one.
    const double left = r[lag - 1], here = r[lag], right = r[lag + 1];
    if (here < left || here < right || here < 0.85 * most || here < kLeastStrength) continue;
    const double bend = left - 2.0 * here + right;
    const double top = static_cast<double>(lag) + (bend < 0.0 ? 0.5 * (left - right) / bend : 0.0);
    return Beat{kSecondsPerMinute / (top * kStep_s), std::min(here, 1.0)};
  }
  return std::nullopt;
}

}  // namespace palpate
