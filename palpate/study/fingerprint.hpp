// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/study/plan.hpp>
#include <palpate/study/run_model.hpp>
#include <string>

namespace palpate::study {

/// SHA-256 of what this program gives on this machine: the bits of exp, log, sin, cos, cbrt, atan2 and pow at 10 000
/// arguments each (the mathematical library chooses their code by the processor), of some rods, and of the plan's id
/// and some of its runs: of single updates 64, evenly spread, of scenarios the beginnings of the first and the last.
/// Where two differ, the results of one do not belong beside those of the other. Cost: milliseconds, and the runs.
std::string fingerprint(const Plan& plan, RunModel& model);

}  // namespace palpate::study
