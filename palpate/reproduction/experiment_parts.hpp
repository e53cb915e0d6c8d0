// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/reproduction/part.hpp>

/// Experiments I and II of the paper as virtual twins: makers for all_parts().
namespace palpate::reproduction {

Part make_table7(const Settings& settings);
Part make_figure9(const Settings& settings);
Part make_figure10(const Settings& settings);
Part make_figure12(const Settings& settings);
Part make_figure14(const Settings& settings);

}  // namespace palpate::reproduction
