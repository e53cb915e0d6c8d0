// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <palpate/study/plan.hpp>
#include <palpate/study/run_model.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::study {

/// What one run left: a value a column (column_names()), or why it could not be played.
struct RunRow {
  std::uint64_t run = 0;
  std::vector<double> values;  ///< NaN where the run failed
  std::string failure;         ///< empty: none
};

struct ShardResult {
  std::uint64_t shard = 0;
  std::vector<RunRow> rows;
};

/// The row of one run: what `figures` measures of it, or why it could not, in words that do not depend on where the
/// files are.
RunRow play(const Plan& plan, std::uint64_t run, const std::function<Figures(const RunKey&)>& figures);
ShardResult compute_shard(const Plan& plan, RunModel& model, std::uint64_t shard);

/// The same as bytes, between processes of one kind of machine.
std::string encode(const ShardResult& result);
/// Precondition: bytes that encode() made.
ShardResult decode(std::string_view bytes);

}  // namespace palpate::study
