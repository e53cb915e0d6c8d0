// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <palpate/math/errors.hpp>
#include <palpate/study/identity.hpp>
#include <palpate/study/results.hpp>

namespace palpate::study {

namespace {

using store::Database;

constexpr std::int64_t kApplication = 0x50616C70;  // "Palp", of PRAGMA application_id
constexpr std::array<std::string_view, 1> kMigrations{
    "CREATE TABLE study (one INTEGER PRIMARY KEY CHECK (one = 1), plan_id TEXT NOT NULL,"
    " fingerprint TEXT NOT NULL, name TEXT NOT NULL, plan TEXT NOT NULL, points INTEGER NOT NULL, runs INTEGER NOT "
    "NULL, shards INTEGER NOT NULL);"
    "CREATE TABLE shard (shard INTEGER PRIMARY KEY, shard_id TEXT NOT NULL UNIQUE, first_run INTEGER NOT NULL,"
    " end_run INTEGER NOT NULL);"};

StudyHead head_of(const Plan& plan, const std::string& fingerprint) {
  StudyHead head{.plan_id = plan_id(plan), .name = plan.name, .fingerprint = fingerprint, .plan = canonical(plan)};
  head.points = plan.points();
  head.runs = plan.runs();
  head.shards = plan.shards();
  return head;
}

std::int64_t as_integer(std::uint64_t number) { return static_cast<std::int64_t>(number); }

void bind_value(store::Statement& statement, int parameter, const nlohmann::json& value) {
  if (value.is_number_integer())
    statement.bind(parameter, value.get<std::int64_t>());
  else if (value.is_number())
    statement.bind(parameter, value.get<double>());
  else
    statement.bind(parameter, value.is_string() ? value.get<std::string>() : value.dump());
}

std::string insert_sql(std::size_t columns) {
  const std::vector<std::string> marks(columns, "?");
  return fmt::format("INSERT INTO run VALUES ({})", fmt::join(marks, ", "));
}

/// In one statement, that a study which is being played meanwhile is seen at one moment.
void count_what_is_done(const Database& database, StudyHead& head) {
  store::Statement row = database.prepare(
      "SELECT (SELECT count(*) FROM shard), (SELECT coalesce(sum(end_run - first_run), 0) FROM shard),"
      " (SELECT count(*) FROM run), (SELECT count(*) FROM run WHERE failure IS NOT NULL)");
  row.step();
  head.shards_done = static_cast<std::uint64_t>(row.integer(0));
  head.runs_done = static_cast<std::uint64_t>(row.integer(1));
  head.runs_failed = static_cast<std::uint64_t>(row.integer(3));
  if (row.integer(1) != row.integer(2))
    throw InputError(fmt::format("{}: holds {} runs: expected {}, those of the shards that are done; it was changed",
                                 database.name(), row.integer(2), head.runs_done));
}

/// A shard's id says which runs it must hold.
void refuse_foreign_shards(const Database& database, const StudyHead& head) {
  const auto shard_runs = head.plan.at("shard_runs").get<std::uint64_t>();
  store::Statement row = database.prepare("SELECT shard, shard_id, first_run, end_run FROM shard");
  while (row.step()) {
    const auto shard = static_cast<std::uint64_t>(row.integer(0));
    const std::uint64_t first = shard * shard_runs, end = std::min(first + shard_runs, head.runs);
    if (shard >= head.shards || row.integer(2) != as_integer(first) || row.integer(3) != as_integer(end) ||
        row.text(1) != shard_id(head.plan_id, {first, end}))
      throw InputError(fmt::format("{}: shard {}: expected one of the {} shards of plan {}; it was changed",
                                   database.name(), row.integer(0), head.shards, head.plan_id.substr(0, 12)));
  }
}

void refuse_other_program(const Database& database) {
  throw InputError(
      fmt::format("{}: was begun by another build of the program, or on another machine, which gives other numbers:"
                  " expected the same to the last bit; choose another --out",
                  database.name()));
}

void refuse_other_plan(const Database& database, const StudyHead& head, const Plan& plan) {
  throw InputError(fmt::format(
      "{}: holds the study \"{}\", plan {}: expected that of {}, plan {}; choose another --out, or move the file away",
      database.name(), head.name, head.plan_id.substr(0, 12), plan.source, plan_id(plan).substr(0, 12)));
}

}  // namespace

void prepare_file(const Database& database) {
  const bool empty = database.integer("SELECT count(*) FROM sqlite_schema") == 0;
  if (!empty && database.integer("PRAGMA application_id") != kApplication)
    throw InputError(
        fmt::format("{}: is a database of another program: expected results of palpate study", database.name()));
  if (empty) database.execute(fmt::format("PRAGMA application_id = {}", kApplication));
  database.migrate(kMigrations);
}

void create_tables(const Database& database, const StudyHead& head) {
  std::string columns =
      "shard INTEGER NOT NULL REFERENCES shard (shard), run INTEGER NOT NULL, point INTEGER NOT NULL,"
      " repeat INTEGER NOT NULL, seed INTEGER NOT NULL, failure TEXT";
  for (const nlohmann::json& p : head.plan.at("parameters"))
    columns += ", " + store::quoted(p.at("name").get<std::string>());
  for (const nlohmann::json& name : head.plan.at("columns"))
    columns += ", " + store::quoted(name.get<std::string>()) + " REAL";
  database.execute(fmt::format("CREATE TABLE run ({}, PRIMARY KEY (shard, run)) WITHOUT ROWID", columns));
  database.prepare("INSERT INTO study VALUES (1, ?, ?, ?, ?, ?, ?, ?)")
      .bind(1, head.plan_id)
      .bind(2, head.fingerprint)
      .bind(3, head.name)
      .bind(4, head.plan.dump())
      .bind(5, as_integer(head.points))
      .bind(6, as_integer(head.runs))
      .bind(7, as_integer(head.shards))
      .run();
}

StudyHead read_head(const Database& database) {
  StudyHead head;
  store::Statement row = database.prepare("SELECT plan_id, name, plan, points, runs, shards, fingerprint FROM study");
  if (!row.step()) throw InputError(fmt::format("{}: holds no study", database.name()));
  head.plan_id = row.text(0);
  head.name = row.text(1);
  head.plan = nlohmann::json::parse(row.text(2), nullptr, false);
  if (head.plan.is_discarded()) throw InputError(fmt::format("{}: study.plan: expected JSON", database.name()));
  head.points = static_cast<std::uint64_t>(row.integer(3));
  head.runs = static_cast<std::uint64_t>(row.integer(4));
  head.shards = static_cast<std::uint64_t>(row.integer(5));
  head.fingerprint = row.text(6);
  count_what_is_done(database, head);
  refuse_foreign_shards(database, head);
  return head;
}

Database open_results(const std::filesystem::path& path) {
  Database database(path, store::OpenMode::kReadOnly);
  if (database.integer("PRAGMA application_id") != kApplication)
    throw InputError(fmt::format("{}: expected results of palpate study", database.name()));
  if (database.integer("PRAGMA user_version") != static_cast<std::int64_t>(kMigrations.size()))
    throw InputError(fmt::format("{}: user_version = {}: expected {}", database.name(),
                                 database.integer("PRAGMA user_version"), kMigrations.size()));
  database.execute("BEGIN");
  return database;
}

Results::Results(const Plan& plan, const Part& part, const std::function<std::string()>& fingerprint,
                 const std::filesystem::path& path)
    : plan_(&plan), plan_id_(plan_id(plan)), lock_(std::make_unique<store::FileLock>(path)) {
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
  try {
    open(part, fingerprint, path);
  } catch (...) {
    database_.reset();
    if (is_new) std::filesystem::remove(path, ignored);
    throw;
  }
  const std::size_t columns = kLeadingColumns + plan.parameters.size() + column_names(plan.measures).size();
  insert_run_ = std::make_unique<store::Statement>(*database_, insert_sql(columns));
  insert_shard_ = std::make_unique<store::Statement>(*database_, "INSERT INTO shard VALUES (?, ?, ?, ?)");
}

void Results::open(const Part& part, const std::function<std::string()>& fingerprint,
                   const std::filesystem::path& path) {
  database_ = std::make_unique<Database>(path);
  {
    store::Transaction transaction(*database_);
    prepare_file(*database_);
    if (database_->integer("SELECT count(*) FROM study") == 0)
      create_tables(*database_, head_of(*plan_, fingerprint_ = fingerprint()));
    transaction.commit();
  }
  const StudyHead head = read_head(*database_);
  if (head.plan_id != plan_id_ || head.shards != plan_->shards()) refuse_other_plan(*database_, head, *plan_);
  done_.resize(plan_->shards());
  store::Statement rows = database_->prepare("SELECT shard FROM shard");
  while (rows.step()) done_[static_cast<std::size_t>(rows.integer(0))] = true;
  if (fingerprint_.empty() && misses(part)) fingerprint_ = fingerprint();
  if (!fingerprint_.empty() && head.fingerprint != fingerprint_) refuse_other_program(*database_);
  // A commit need not wait for the disk: a killed process loses nothing, and a power cut at most the latest shards.
  database_->execute("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL");
}

bool Results::misses(const Part& part) const {
  for (std::uint64_t shard = 0; shard < done_.size(); ++shard)
    if (part.holds(shard) && !done_[shard]) return true;
  return false;
}

Results::~Results() {
  try {  // a write-ahead log would come back with every reader, and stay
    insert_run_.reset();
    insert_shard_.reset();
    database_->execute("PRAGMA journal_mode = DELETE");
  } catch (const InputError&) {  // a reader has it open: the log goes with the next run
  }
}

void Results::add(const ShardResult& result) {
  const RunRange range = shard_range(*plan_, result.shard);
  store::Transaction transaction(*database_);
  insert_shard_->bind(1, as_integer(result.shard))
      .bind(2, shard_id(plan_id_, range))
      .bind(3, as_integer(range.first))
      .bind(4, as_integer(range.end))
      .run();
  std::vector<nlohmann::json> point;
  std::uint64_t of_point = plan_->points();
  for (const RunRow& row : result.rows) {
    const RunKey key = run_key(*plan_, row.run);
    if (key.point != of_point) point = point_values(*plan_, of_point = key.point);
    store::Statement& s = *insert_run_;
    s.bind(1, as_integer(result.shard)).bind(2, as_integer(row.run)).bind(3, as_integer(key.point));
    s.bind(4, as_integer(key.repeat)).bind(5, as_integer(key.seed));
    row.failure.empty() ? s.bind(6, std::numeric_limits<double>::quiet_NaN()) : s.bind(6, row.failure);
    int column = kLeadingColumns;
    for (const nlohmann::json& value : point) bind_value(s, ++column, value);
    for (const double value : row.values) s.bind(++column, value);
    s.run();
  }
  transaction.commit();
  done_[result.shard] = true;
}

StudyHead Results::head() const { return read_head(*database_); }

}  // namespace palpate::study
