// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/plot/plot.hpp>
#include <palpate/reproduction/experiment_runs.hpp>

/// Curves of a run over time; forces in mN, tip axes.
namespace palpate::reproduction {

plot::Series true_series(const ExperimentRun& run, int axis, const std::string& label);
/// With a band of 95 % where the estimator is the smoothed one.
plot::Series force_series(const ExperimentRun& run, Estimator estimator, int axis);
/// estimate - truth, from the first judged frame on.
plot::Series error_series(const ExperimentRun& run, Estimator estimator, int axis, double until_s);
/// EI1 (0) or EI2 (1) in mN m^2: true, by the paper's IEKF and IAEKF, and by ours with its band of 95 %.
std::vector<plot::Series> stiffness_series(const ExperimentRun& run, int which);

}  // namespace palpate::reproduction
