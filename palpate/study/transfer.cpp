// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <palpate/math/errors.hpp>
#include <palpate/study/transfer.hpp>
#include <system_error>

namespace palpate::study {

namespace {

using store::Database;

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return store::quoted(text);  // as SQL has it
}

std::string field(const store::Statement& row, int column) {
  if (row.is_null(column)) return {};
  if (row.is_text(column)) return csv_text(row.text(column));
  if (row.is_integer(column)) return fmt::format("{}", row.integer(column));
  return fmt::format("{}", row.number(column));
}

/// A file beside the target that is gone, with all that SQLite puts beside it, unless it is put in place. The target is
/// locked as a study locks it, so that none can begin there meanwhile.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& target)
      : target_(target), lock_(target), temporary_(target.string() + fmt::format(".{}.tmp", ::getpid())) {
    std::error_code ignored;
    if (std::filesystem::exists(std::filesystem::symlink_status(target, ignored))) fail(EEXIST);
  }
  ~NewFile() {
    std::error_code ignored;
    for (const char* ending : {"", "-journal", "-wal", "-shm"})
      std::filesystem::remove(temporary_.string() + ending, ignored);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  const std::filesystem::path& path() const { return temporary_; }
  void put_in_place() const {
    // Some file systems know but one of the two.
    if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) != 0 &&
        (errno != EINVAL || ::link(temporary_.c_str(), target_.c_str()) != 0))
      fail(errno);
  }

 private:
  [[noreturn]] void fail(int error) const {
    if (error == EEXIST) throw InputError(fmt::format("{}: is there already: expected a new file", target_.string()));
    throw InputError(fmt::format("{}: cannot be written: {}", target_.string(), std::strerror(error)));
  }

  std::filesystem::path target_;
  store::FileLock lock_;
  std::filesystem::path temporary_;
};

/// Shards that both have are the same to the last bit, or one of the two is broken.
void refuse_contradictions(const Database& merged, const std::filesystem::path& input) {
  const std::int64_t shard = merged.integer(
      "WITH both AS (SELECT shard FROM main.shard INTERSECT SELECT shard FROM other.shard)"
      "SELECT 1 + min(shard) FROM (SELECT * FROM other.run WHERE shard IN both"
      " EXCEPT SELECT * FROM main.run WHERE shard IN both)");
  if (shard > 0)
    throw InputError(
        fmt::format("{}: shard {}: expected the rows that another file has for it", input.string(), shard - 1));
}

void add(const Database& merged, const std::filesystem::path& input) {
  merged.attach(input, "other");
  {
    store::Transaction transaction(merged);
    refuse_contradictions(merged, input);
    merged.execute(
        "CREATE TEMP TABLE news AS SELECT shard FROM other.shard WHERE shard NOT IN (SELECT shard FROM main.shard);"
        "INSERT INTO main.shard SELECT * FROM other.shard WHERE shard IN (SELECT shard FROM news) ORDER BY shard;"
        "INSERT INTO main.run SELECT * FROM other.run WHERE shard IN (SELECT shard FROM news) ORDER BY shard, run;"
        "DROP TABLE news");
    transaction.commit();
  }
  merged.execute("DETACH DATABASE other");
}

}  // namespace

std::uint64_t export_csv(const Database& database, const std::function<void(std::string_view)>& write) {
  store::Statement row = database.prepare("SELECT * FROM run ORDER BY shard, run");
  const auto write_line = [&](const auto& field_of) {
    std::string line;
    for (int c = 0; c < row.columns(); ++c) {
      line += field_of(row, c);
      line += c + 1 < row.columns() ? ',' : '\n';
    }
    write(line);
  };
  write_line([](const store::Statement& s, int c) { return csv_text(s.column_name(c)); });
  std::uint64_t rows = 0;
  for (; row.step(); ++rows) write_line(field);
  return rows;
}

StudyHead merge_results(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& out) {
  const NewFile file(out);
  const StudyHead head = read_head(open_results(inputs.front()));
  for (const std::filesystem::path& input : inputs) {
    const StudyHead other = read_head(open_results(input));
    if (other.plan_id != head.plan_id)
      throw InputError(fmt::format("{}: holds plan {}: expected {}, that of {}", input.string(),
                                   other.plan_id.substr(0, 12), head.plan_id.substr(0, 12), inputs.front().string()));
    if (other.fingerprint != head.fingerprint)
      throw InputError(fmt::format(
          "{}: is of another build of the program than {}, or of another machine, which gives other numbers: expected"
          " parts that one build played",
          input.string(), inputs.front().string()));
  }
  StudyHead merged_head;
  {
    const Database merged(file.path());
    store::Transaction transaction(merged);
    prepare_file(merged);
    create_tables(merged, head);
    transaction.commit();
    for (const std::filesystem::path& input : inputs) add(merged, input);
    merged_head = read_head(merged);
  }
  file.put_in_place();
  return merged_head;
}

}  // namespace palpate::study
