// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/toml_table.hpp>
#include <palpate/study/plan.hpp>
#include <vector>

namespace palpate::study {

/// Tries the files as they are, then each value of each parameter by itself (of a range both ends). `vary`: where they
/// stand in the study file. Throws InputError naming that place, with the nearest setting where there is none of this
/// name.
void check_parameters(const Plan& plan, const std::vector<TomlTable>& vary);

}  // namespace palpate::study
