// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/service/settings.hpp>

namespace palpate::app {

struct LiveOptions {
  double for_s = 0.0;  ///< ends by itself after so long; 0: never
  bool json = false;   ///< ports and the summary at the end as JSON, one line each
  bool print = false;  ///< the force of every catheter twice a second, a line each, whether or not on a terminal
};

/// Runs the instrument until it is told to end or its sources have ended; says at the start where it is to be found and
/// at the end what it did. Exit code: 0, or 1 where records were lost. Throws InputError.
int run_live(service::Settings settings, const LiveOptions& options);

}  // namespace palpate::app
