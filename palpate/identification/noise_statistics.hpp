// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

/// Statistics of one channel of a sensor that stands still.
namespace palpate {

/// Value below which this share of `values` lies. Not empty. Takes a copy: it is reordered.
double quantile(std::vector<double> values, double share);

/// How many samples, evenly counted, tell as much as one independent one: 1 + 2 sum rho(k), at least 1. It divides N in
/// the variance of a mean. The sum is cut off at the first lag beyond five times itself (Sokal's window), at most at a
/// third of the samples. One where there is no variance. N * lags operations.
double samples_per_independent(const std::vector<double>& values);

/// Smallest difference between two distinct values: the step of a quantised channel. Zero where all are alike.
double smallest_step(std::vector<double> values);

/// Mean square of the quantisation error that a sensor at rest does not show: its mean at an unknown place in the step,
///
///   q^2 / (2 pi^2) sum_k exp(-4 pi^2 k^2 sigma^2 / q^2) / k^2 ,
///
/// q^2/12 without noise, nothing where the noise dithers it (sigma > q/2). `observed_variance` is that of the quantised
/// values; sigma^2 is what remains of it without q^2/12.
/// Source: the characteristic function of a rounded Gaussian; Widrow & Kollar, Quantization Noise (2008), chapter 4.
double hidden_quantisation_variance(double step, double observed_variance);

/// Half the mean square of x(i + lag) - x(i): the variance of what forgets itself within `lag` samples.
double difference_variance(const std::vector<double>& values, std::size_t lag);

/// Overlapping Allan variance over windows of `count` samples, 1 <= 2 count <= N:
/// half the mean square difference of neighbouring window means. White noise falls as 1 / count, drift rises.
double allan_variance(const std::vector<double>& values, std::size_t count);

}  // namespace palpate
