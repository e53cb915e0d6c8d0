// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <palpate/estimation/adaptation.hpp>

namespace palpate {

NoiseAdaptation::NoiseAdaptation(int channels, int window, const Limits& limits)
    : channel_(static_cast<std::size_t>(channels)), limits_(limits) {
  for (Channel& channel : channel_) {
    channel.residual.setZero(window);
    channel.projected.setZero(window);
  }
}

void NoiseAdaptation::apply(const Channels& channels, ResidualMatrix& noise) const {
  for (Eigen::Index i = 0; i < noise.rows(); ++i) {
    const double scale = std::sqrt(ratio(channels[static_cast<std::size_t>(i)]));
    noise.row(i) *= scale;
    noise.col(i) *= scale;
  }
}

void NoiseAdaptation::observe(const Channels& channels, const ResidualMatrix& nominal_noise, const Linearization& at,
                              const StateMatrix& posterior_covariance) {
  for (Eigen::Index i = 0; i < at.residual.size(); ++i) {
    Channel& channel = channel_[static_cast<std::size_t>(channels[static_cast<std::size_t>(i)])];
    const int window = static_cast<int>(channel.residual.size());
    const double nominal = nominal_noise(i, i);
    channel.residual(channel.next) = at.residual(i) / std::sqrt(nominal);
    channel.projected(channel.next) =
        at.jacobian.row(i).dot(posterior_covariance * at.jacobian.row(i).transpose()) / nominal;
    channel.next = (channel.next + 1) % window;
    channel.count = std::min(channel.count + 1, window);
    if (channel.count < 2) continue;

    const auto r = channel.residual.head(channel.count), projected = channel.projected.head(channel.count);
    const double samples = channel.count;
    const double matched = (r - r.mean()).square().sum() / (samples - 1.0) + projected.mean();
    const double shrunk = (limits_.prior_samples + samples * matched) / (limits_.prior_samples + samples);
    channel.ratio = std::clamp(shrunk, limits_.least_ratio, limits_.largest_ratio);
  }
}

}  // namespace palpate
