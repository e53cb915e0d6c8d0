// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <palpate/recording/catheter_file.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bindings.hpp"

/// What a catheter is told by, and how it is said as a file again.
namespace palpate::python {

/// "pose", "pose5", "position".
std::string_view name_of(SensorKind kind);

/// A stretch of shaft as told by keywords: what is absent is the whole catheter's.
struct ShaftSection {
  double from_m = 0.0, to_m = 0.0;
  std::optional<Eigen::Vector2d> bending_stiffness_Nm2 = {};
  std::optional<double> torsional_stiffness_Nm2 = {};
  std::optional<Vector3d> precurvature_per_m = {};
  bool rigid = false;
};
/// All of it said.
ShaftSection told_section(const Section& section);

/// Throws py::type_error on a keyword that is none of these, with the nearest that is. `kind`: the class, for messages.
void require_known(const py::kwargs& given, std::string_view kind, const std::vector<std::string_view>& known);

/// From keywords (their list is Catheter's docstring); None: not given. Throws py::type_error on one that is unknown,
/// missing or of the wrong class, InputError on a value.
CatheterFile catheter_from_keywords(const py::kwargs& given);

/// Reads a text as a catheter file; `name`: for messages. Throws InputError.
CatheterFile catheter_from_text(const std::string& text, const std::string& name);

/// A catheter file that reads back as this one, numbers to the last bit or the next. Throws InputError where no
/// catheter file may say it.
std::string catheter_toml(const CatheterFile& file);

void bind_catheter_parts(py::module_& m);

}  // namespace palpate::python
