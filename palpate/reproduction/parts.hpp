// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/part.hpp>

/// The makers behind all_parts().
namespace palpate::reproduction {

Part make_table2(const Settings& settings);
Part make_figure3(const Settings& settings);
Part make_table3(const Settings& settings);
Part make_figure4(const Settings& settings);
Part make_figure5(const Settings& settings);
Part make_figure6(const Settings& settings);
Part make_table4(const Settings& settings);
Part make_table5(const Settings& settings);
Part make_figure7(const Settings& settings);
Part make_table6(const Settings& settings);

// Experiments I and II as virtual twins.
Part make_figure9(const Settings& settings);
Part make_figure10(const Settings& settings);
Part make_table7(const Settings& settings);
Part make_figure12(const Settings& settings);
Part make_figure14(const Settings& settings);

Part make_iterations(const Settings& settings);
Part make_window(const Settings& settings);

// Corrections to the paper, each demonstrated.
Part make_eq8(const Settings& settings);
Part make_euler(const Settings& settings);
Part make_curvature_channel(const Settings& settings);
Part make_scale(const Settings& settings);
Part make_divergence(const Settings& settings);

}  // namespace palpate::reproduction
