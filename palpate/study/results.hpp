// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <palpate/store/database.hpp>
#include <palpate/store/file_lock.hpp>
#include <palpate/study/plan.hpp>
#include <palpate/study/shard.hpp>
#include <string>
#include <string_view>
#include <vector>

/// Where results are kept: one SQLite file, written by one process; readers are welcome meanwhile.
///
///     study   one row: the plan, its id, its title, how many points, runs and shards it has
///     shard   one row a shard that is done, with its id
///     run     one row a run: shard, run, point, repeat, seed, failure, a column a parameter, a column a measure
///
/// The rows of a shard and its row in `shard` are one transaction: a shard is there whole or not at all.
namespace palpate::study {

/// What a file of results is of.
struct StudyHead {
  std::string plan_id, name;
  std::string fingerprint;  ///< of the program and machine that began it (fingerprint.hpp)
  nlohmann::json plan;      ///< canonical()
  std::uint64_t points = 0, runs = 0, shards = 0;
  std::uint64_t shards_done = 0, runs_done = 0, runs_failed = 0;
};

class Results {
 public:
  /// Makes the file, or goes on with one that is of this plan and, where some of `part` is missing, has this
  /// fingerprint, which is asked for once the file is locked, and only where it is needed. Throws InputError where
  /// another process writes it, it is of another plan or program or no file of results, or it cannot be written; then
  /// it is as it was.
  Results(const Plan& plan, const Part& part, const std::function<std::string()>& fingerprint,
          const std::filesystem::path& path);

  ~Results();  ///< leaves one file, where no reader has it open
  Results(const Results&) = delete;
  Results& operator=(const Results&) = delete;

  bool done(std::uint64_t shard) const { return done_[shard]; }
  /// One transaction.
  void add(const ShardResult& result);
  StudyHead head() const;
  /// Of this program; empty where nothing was missing.
  const std::string& fingerprint() const { return fingerprint_; }
  /// In a forked child: the file stays the parent's.
  void abandon() noexcept { lock_->abandon(); }

 private:
  void open(const Part& part, const std::function<std::string()>& fingerprint, const std::filesystem::path& path);
  bool misses(const Part& part) const;

  const Plan* plan_;
  std::string plan_id_, fingerprint_;
  std::unique_ptr<store::FileLock> lock_;  // before the database: outlives it
  std::unique_ptr<store::Database> database_;
  std::unique_ptr<store::Statement> insert_run_, insert_shard_;
  std::vector<bool> done_;
};

/// The file for reading, as it stands now: what is added later is not seen. Throws InputError where it is no file of
/// results.
store::Database open_results(const std::filesystem::path& path);
/// Throws InputError where shards are not whole, or are none of its plan.
StudyHead read_head(const store::Database& database);

/// Makes `database`, new or empty, one of this study. In a transaction of the caller's.
void create_tables(const store::Database& database, const StudyHead& head);
/// Brings an older file up to date, marks a new one as ours. Throws InputError where it is another program's.
void prepare_file(const store::Database& database);

/// Columns of `run` in front of those of the parameters.
inline constexpr int kLeadingColumns = 6;

}  // namespace palpate::study
