// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/recording/catheter_file.hpp>
#include <palpate/recording/toml_edit.hpp>
#include <string>

#include "bindings.hpp"

namespace palpate::python {

/// From where to where an identified value is written: as the command line's --catheter and --out.
struct FitFiles {
  std::string catheter, out;
  CatheterFile stated;  ///< what the file says now
};

/// The catheter to which a fit was made, and what of it counts besides the shaft and where its sensors sit.
struct Fitted {
  Catheter catheter;
  bool poses = false;      ///< mountings, noise and delays: sensors took part
  bool base = false;       ///< where the clamp stands, and how well that is known
  bool stiffness = false;  ///< counts under weight in any case
};

/// Throws InputError where a path cannot be used, the file cannot be read, or differs in anything on which the fit
/// rests: what was identified would then be another catheter's. The message has all that differs.
FitFiles fit_files(const py::object& catheter, const py::object& out, const Fitted& fitted);

}  // namespace palpate::python
