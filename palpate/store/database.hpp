// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// A thin layer over SQLite: what recordings and studies are kept in. Every failure throws InputError with the file's
/// path and SQLite's reason.
namespace palpate::store {

class Database;

/// A prepared statement. Parameters and columns count from 1 and 0, as SQLite has them. It must not outlive its
/// Database.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);

  Statement& bind(int parameter, std::int64_t value);
  Statement& bind(int parameter, double value);  ///< NaN is stored as NULL
  Statement& bind(int parameter, std::string_view value);
  /// Without a copy of the text, which must stay until the next value.
  Statement& bind_word(int parameter, std::string_view value);
  /// Every parameter is NULL again.
  Statement& clear();

  /// Goes to the next row; false at the end.
  bool step();
  /// Steps to the end and makes ready for the next values.
  void run();
  void reset();
  /// As reset(), of a statement that has failed: its failure has been told.
  void abandon() noexcept;

  int columns() const;
  std::string column_name(int column) const;
  bool is_null(int column) const;
  bool is_text(int column) const;
  bool is_integer(int column) const;
  std::int64_t integer(int column) const;
  double number(int column) const;  ///< NULL is NaN
  std::string text(int column) const;

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  void check(int code) const;

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

enum class OpenMode {
  kCreate,    ///< read and write; made where it is absent
  kReadOnly,  ///< must be there
  kSalvage,   ///< as kReadOnly; a file that is cut off or partly damaged opens, too, as far as its first page is whole
  kAsItLies,  ///< as kSalvage, of the main file alone: no journal is looked at, no lock taken, nothing made beside it
};

/// One SQLite file. One object a thread; not to be used on the other side of a fork.
class Database {
 public:
  explicit Database(const std::filesystem::path& path, OpenMode mode = OpenMode::kCreate);

  /// One or several statements without parameters, results ignored.
  void execute(const std::string& sql) const;
  Statement prepare(std::string_view sql) const { return {*this, sql}; }
  /// The first column of the first row; 0 where there is none.
  std::int64_t integer(std::string_view sql) const;

  /// Brings the file to the last of `steps`: step i is run where PRAGMA user_version is i, and makes it i + 1. All of
  /// them in one transaction, the caller's where there is one. Throws InputError where the file is of a later program.
  void migrate(std::span<const std::string_view> steps) const;

  /// A second file, whose tables are called SCHEMA.TABLE.
  void attach(const std::filesystem::path& path, const std::string& schema) const;

  const std::string& name() const { return name_; }
  [[noreturn]] void fail(std::string_view what) const;  ///< with SQLite's reason

 private:
  friend class Statement;
  struct Close {
    void operator()(sqlite3* database) const;
  };
  std::string name_;  ///< the path as given
  std::unique_ptr<sqlite3, Close> handle_;
};

/// All that is written until commit(), or nothing of it.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  const Database* database_;
  bool open_ = true;
};

/// A name as SQL quotes it: "a.b".
std::string quoted(std::string_view name);

}  // namespace palpate::store
