// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/observer/options.hpp>
#include <palpate/recording/toml_table.hpp>

namespace palpate {

/// [estimator] of a catheter file. What is absent stays as it is in `options`.
void read_estimator(const TomlTable& root, ObserverOptions& options);

}  // namespace palpate
