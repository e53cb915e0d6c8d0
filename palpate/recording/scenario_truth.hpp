// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <palpate/recording/toml_table.hpp>
#include <palpate/sensing/catheter.hpp>

namespace palpate {

/// A catheter as it might truly be, drawn from what its file is unsure of: stiffness, precurvature, base, mounting.
/// Same seed, same catheter.
Catheter draw_catheter(const Catheter& believed, std::uint64_t seed);

/// [truth] of a scenario file: makes of the catheter that the operator believes in the one that is on the table.
/// `drawn` tells whether it was drawn.
Catheter read_truth(const TomlTable& root, const Catheter& believed, std::uint64_t seed, bool& drawn);

}  // namespace palpate
