// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <sqlite3.h>

#include <cmath>
#include <limits>
#include <optional>
#include <palpate/math/errors.hpp>
#include <palpate/store/database.hpp>

namespace palpate::store {

namespace {

/// A path that SQLite takes for nothing else: `:memory:` and `file:...` are names of files, too.
std::string plain_path(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(path, error);
  if (error) throw InputError(fmt::format("{}: cannot be opened: {}", path.string(), error.message()));
  return absolute.string();
}

/// The same as a URI, which alone can say that nothing but the file itself is to be touched.
std::string immutable_uri(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : plain_path(path)) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '/';
    uri += plain ? std::string(1, c) : fmt::format("%{:02x}", static_cast<unsigned char>(c));
  }
  return uri + "?immutable=1";
}

int flags_of(OpenMode mode) {
  if (mode == OpenMode::kCreate) return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  return mode == OpenMode::kAsItLies ? SQLITE_OPEN_READONLY | SQLITE_OPEN_URI : SQLITE_OPEN_READONLY;
}

}  // namespace

void Database::Close::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const std::filesystem::path& path, OpenMode mode) : name_(path.string()) {
  const std::string file = mode == OpenMode::kAsItLies ? immutable_uri(path) : plain_path(path);
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &handle, flags_of(mode), nullptr);
  handle_.reset(handle);
  if (code != SQLITE_OK) fail("cannot be opened");
  sqlite3_busy_timeout(handle, 5000);
  execute("PRAGMA foreign_keys = ON");
  if (mode == OpenMode::kSalvage || mode == OpenMode::kAsItLies)  // or a file shorter than it says is refused whole
    execute("PRAGMA writable_schema = ON; PRAGMA cell_size_check = ON");
  integer("SELECT count(*) FROM sqlite_schema");  // what is no database says so here
}

void Database::fail(std::string_view what) const {
  throw InputError(fmt::format("{}: {}: {}", name_, what, sqlite3_errmsg(handle_.get())));
}

void Database::execute(const std::string& sql) const {
  if (sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail("cannot be used");
}

std::int64_t Database::integer(std::string_view sql) const {
  Statement statement(*this, sql);
  return statement.step() ? statement.integer(0) : 0;
}

void Database::migrate(std::span<const std::string_view> steps) const {
  const auto last = static_cast<std::int64_t>(steps.size());
  const std::int64_t version = integer("PRAGMA user_version");
  if (version > last)
    throw InputError(fmt::format("{}: user_version = {}: expected at most {}; it was written by a later program", name_,
                                 version, last));
  if (version == last) return;
  std::optional<Transaction> transaction;
  if (sqlite3_get_autocommit(handle_.get()) != 0) transaction.emplace(*this);
  for (std::int64_t i = version; i < last; ++i) execute(std::string(steps[static_cast<std::size_t>(i)]));
  execute(fmt::format("PRAGMA user_version = {}", last));
  if (transaction) transaction->commit();
}

void Database::attach(const std::filesystem::path& path, const std::string& schema) const {
  prepare("ATTACH DATABASE ? AS " + store::quoted(schema)).bind(1, plain_path(path)).run();
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

Statement::Statement(const Database& database, std::string_view sql) : database_(&database) {
  sqlite3_stmt* statement = nullptr;
  check(sqlite3_prepare_v2(database.handle_.get(), sql.data(), static_cast<int>(sql.size()), &statement, nullptr));
  statement_.reset(statement);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) database_->fail("cannot be used");
}

Statement& Statement::bind(int parameter, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), parameter, value));
  return *this;
}

Statement& Statement::bind(int parameter, double value) {
  check(std::isnan(value) ? sqlite3_bind_null(statement_.get(), parameter)
                          : sqlite3_bind_double(statement_.get(), parameter, value));
  return *this;
}

Statement& Statement::bind(int parameter, std::string_view value) {
  const auto size = static_cast<sqlite3_uint64>(value.size());
  check(sqlite3_bind_text64(statement_.get(), parameter, value.data(), size, SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Statement& Statement::bind_word(int parameter, std::string_view value) {
  const auto size = static_cast<sqlite3_uint64>(value.size());
  check(sqlite3_bind_text64(statement_.get(), parameter, value.data(), size, SQLITE_STATIC, SQLITE_UTF8));
  return *this;
}

Statement& Statement::clear() {
  check(sqlite3_clear_bindings(statement_.get()));
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_->fail("cannot be read or written");
  return code == SQLITE_ROW;
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

void Statement::abandon() noexcept { sqlite3_reset(statement_.get()); }

void Statement::reset() { check(sqlite3_reset(statement_.get())); }

int Statement::columns() const { return sqlite3_column_count(statement_.get()); }

std::string Statement::column_name(int column) const { return sqlite3_column_name(statement_.get(), column); }

bool Statement::is_null(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL; }

bool Statement::is_text(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_TEXT; }

bool Statement::is_integer(int column) const { return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER; }

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }

double Statement::number(int column) const {
  return is_null(column) ? std::numeric_limits<double>::quiet_NaN() : sqlite3_column_double(statement_.get(), column);
}

std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text), size);
}

Transaction::Transaction(const Database& database) : database_(&database) { database.execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_->execute("ROLLBACK");
  } catch (const InputError&) {  // SQLite has rolled back by itself; the first error is the one to tell
  }
}

void Transaction::commit() {
  database_->execute("COMMIT");
  open_ = false;
}

std::string quoted(std::string_view name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
}

}  // namespace palpate::store
