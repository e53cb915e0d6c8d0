// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <palpate/study/results.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::study {

/// The canonical export: CSV, a header, then the rows of every shard that is done, sorted by shard and run; numbers
/// with as few digits as say which they are. The same results give the same bytes, whoever computed them in which
/// order. `write` gets it piece by piece. Returns the number of rows.
std::uint64_t export_csv(const store::Database& database, const std::function<void(std::string_view)>& write);

/// One new file of what several hold of the same study. Throws InputError where their plans differ, a shard stands in
/// two of them with different rows, an input is `out`, or `out` is there already; then nothing is written.
StudyHead merge_results(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out);

}  // namespace palpate::study
