// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/service/counters.hpp>

namespace palpate::service {

void LatencyHistogram::add(std::int64_t latency_ns) {
  const double latency_us = std::max(1e-3 * static_cast<double>(latency_ns), 1.0);
  const auto bin = static_cast<std::size_t>(kBinsADecade * std::log10(latency_us));
  bins_[std::min(bin, bins_.size() - 1)].add();
  if (latency_ns > static_cast<std::int64_t>(most_ns_.get())) most_ns_.set(static_cast<std::uint64_t>(latency_ns));
}

std::uint64_t LatencyHistogram::count() const {
  std::uint64_t count = 0;
  for (const Counter& bin : bins_) count += bin.get();
  return count;
}

double LatencyHistogram::percentile_s(double share) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count())));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < bins_.size() && wanted > 0; ++i)
    if ((seen += bins_[i].get()) >= wanted) return std::min(upper_end_s(i), most_s());
  return 0.0;
}

std::vector<LatencyHistogram::Bin> LatencyHistogram::bins() const {
  std::vector<Bin> out;
  for (std::size_t i = 0; i < bins_.size(); ++i)
    if (const std::uint64_t count = bins_[i].get(); count > 0) out.push_back({upper_end_s(i), count});
  return out;
}

double LatencyHistogram::upper_end_s(std::size_t bin) {
  return 1e-6 * std::pow(10.0, static_cast<double>(bin + 1) / kBinsADecade);
}

}  // namespace palpate::service
