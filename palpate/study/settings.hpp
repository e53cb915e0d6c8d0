// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <palpate/study/plan.hpp>
#include <string>
#include <string_view>

namespace palpate::study {

/// Puts one value into the files that a run is made of, by its dotted name:
///
///     scenario.KEY, scenario.TABLE.KEY      of the scenario file ([scenario], [TABLE])
///     catheter.KEY, catheter.TABLE.KEY      of the catheter file ([catheter], [TABLE])
///     catheter.sensor.NAME.KEY              of the [[sensor]] of that name
///     filter.KEY                            of the catheter file's [estimator]
///     update.KEY                            of the study file's [update]
///
/// KEY[i] is the i-th element (from 0) of an array that is there. Units are the file's. That the key exists and the
/// value may be is judged by whoever reads the files. Throws InputError, without a place, where the name is none of
/// these or names no sensor or element.
void put_setting(std::string_view name, const nlohmann::json& value, Documents& documents);

/// The same for all parameters of a point.
Documents documents_at(const Plan& plan, const std::vector<nlohmann::json>& values);

}  // namespace palpate::study
