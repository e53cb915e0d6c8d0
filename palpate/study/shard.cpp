// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/study/shard.hpp>

namespace palpate::study {

namespace {

void put(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  std::string_view take(std::size_t size) {
    const std::string_view piece = bytes_.substr(0, size);
    bytes_.remove_prefix(piece.size());
    return piece;
  }
  std::uint64_t number() {
    std::uint64_t n = 0;
    std::memcpy(&n, take(sizeof n).data(), sizeof n);
    return n;
  }

 private:
  std::string_view bytes_;
};

}  // namespace

RunRow play(const Plan& plan, std::uint64_t run, const std::function<Figures(const RunKey&)>& figures) {
  RunRow row{.run = run, .values = {}, .failure = {}};
  try {
    row.values = column_values(figures(run_key(plan, run)), plan.measures);
  } catch (const InputError& error) {
    row.values.assign(column_names(plan.measures).size(), std::numeric_limits<double>::quiet_NaN());
    row.failure = without_place(plan, error.what());
  }
  return row;
}

ShardResult compute_shard(const Plan& plan, RunModel& model, std::uint64_t shard) {
  const RunRange range = shard_range(plan, shard);
  ShardResult result{.shard = shard, .rows = {}};
  const auto figures = [&model](const RunKey& key) { return model.run(key); };
  for (std::uint64_t run = range.first; run < range.end; ++run) result.rows.push_back(play(plan, run, figures));
  return result;
}

std::string encode(const ShardResult& result) {
  std::string bytes;
  put(bytes, result.shard);
  put(bytes, result.rows.size());
  for (const RunRow& row : result.rows) {
    put(bytes, row.run);
    put(bytes, row.values.size());
    bytes.append(reinterpret_cast<const char*>(row.values.data()), row.values.size() * sizeof(double));
    put(bytes, row.failure.size());
    bytes += row.failure;
  }
  return bytes;
}

ShardResult decode(std::string_view bytes) {
  Reader reader(bytes);
  ShardResult result{.shard = reader.number(), .rows = {}};
  result.rows.resize(reader.number());
  for (RunRow& row : result.rows) {
    row.run = reader.number();
    row.values.resize(reader.number());
    const std::string_view values = reader.take(row.values.size() * sizeof(double));
    if (!values.empty()) std::memcpy(row.values.data(), values.data(), values.size());
    row.failure = std::string(reader.take(reader.number()));
  }
  return result;
}

}  // namespace palpate::study
