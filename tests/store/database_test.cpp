// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <palpate/math/errors.hpp>
#include <palpate/store/database.hpp>
#include <palpate/store/file_lock.hpp>
#include <tests/recording/temporary_folder.hpp>

/// The layer over SQLite: what is written is read back, a transaction is whole or not there, errors name the file.
namespace palpate::store {
namespace {

using ::testing::HasSubstr;

class Store : public test::TemporaryFolder {
 protected:
  template <typename Act>
  static std::string refused(const Act& act) {
    try {
      act();
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing was refused";
  }
};

TEST_F(Store, ValuesComeBackToTheLastBit) {
  const Database database(path("a.db"));
  database.execute("CREATE TABLE t (i INTEGER, x REAL, s TEXT, n REAL)");
  const std::string text("a\0b\"", 4);
  const std::int64_t least = std::numeric_limits<std::int64_t>::min();
  const double x = std::nextafter(0.1, 1.0);
  database.prepare("INSERT INTO t VALUES (?, ?, ?, ?)")
      .bind(1, least)
      .bind(2, x)
      .bind(3, text)
      .bind(4, std::nan(""))
      .run();
  Statement row = database.prepare("SELECT * FROM t");
  ASSERT_TRUE(row.step());
  EXPECT_EQ(row.integer(0), least);
  EXPECT_EQ(row.number(1), x);
  EXPECT_EQ(row.text(2), text);
  EXPECT_TRUE(row.is_null(3));
  EXPECT_TRUE(std::isnan(row.number(3)));
  EXPECT_EQ(row.column_name(2), "s");
  EXPECT_FALSE(row.step());
}

TEST_F(Store, ATransactionWithoutCommitLeavesNothing) {
  const Database database(path("a.db"));
  database.execute("CREATE TABLE t (i)");
  {
    const Transaction transaction(database);
    database.execute("INSERT INTO t VALUES (1)");
  }
  EXPECT_EQ(database.integer("SELECT count(*) FROM t"), 0);
  Transaction transaction(database);
  database.execute("INSERT INTO t VALUES (2)");
  transaction.commit();
  EXPECT_EQ(database.integer("SELECT i FROM t"), 2);
}

TEST_F(Store, MigrationsRunOnceAndInOrder) {
  const std::array<std::string_view, 2> steps{"CREATE TABLE t (i)", "INSERT INTO t VALUES (7)"};
  const Database database(path("a.db"));
  database.migrate(std::span(steps).first(1));
  EXPECT_EQ(database.integer("SELECT count(*) FROM t"), 0);
  database.migrate(steps);
  database.migrate(steps);
  EXPECT_EQ(database.integer("SELECT count(*) FROM t"), 1);
  EXPECT_EQ(database.integer("PRAGMA user_version"), 2);
  EXPECT_THAT(refused([&] { database.migrate(std::span(steps).first(1)); }),
              HasSubstr("a.db: user_version = 2: expected at most 1"));
}

TEST_F(Store, AFailedMigrationChangesNothing) {
  const std::array<std::string_view, 2> steps{"CREATE TABLE t (i)", "INSERT INTO nowhere VALUES (7)"};
  const Database database(path("a.db"));
  EXPECT_THAT(refused([&] { database.migrate(steps); }), HasSubstr("no such table: nowhere"));
  EXPECT_EQ(database.integer("SELECT count(*) FROM sqlite_schema"), 0);
  EXPECT_EQ(database.integer("PRAGMA user_version"), 0);
}

TEST_F(Store, ErrorsNameTheFile) {
  std::ofstream(path("text.db"))
      << "time_s,frame,sensor\n0,0,tip and some more, so that it is long enough for a header....\n";
  EXPECT_THAT(refused([&] { Database(path("text.db")); }),
              HasSubstr("text.db: cannot be used: file is not a database"));
  EXPECT_THAT(refused([&] { Database(path("no/a.db")); }), HasSubstr("no/a.db: cannot be opened: unable to open"));
  EXPECT_THAT(refused([&] { Database(path("none.db"), OpenMode::kReadOnly); }), HasSubstr("none.db: cannot be opened"));
}

TEST_F(Store, ALockIsOneProcesssAndGoesWithIt) {
  {
    const FileLock lock(path("r.db"));
    EXPECT_THAT(refused([&] { FileLock second(path("r.db")); }), HasSubstr("r.db: another process is writing it"));
  }
  EXPECT_FALSE(std::filesystem::exists(path("r.db.lock")));
  std::ofstream(path("r.db")) << "";
  std::filesystem::create_symlink(path("r.db"), path("link.db"));
  {
    const FileLock lock(path("r.db"));
    EXPECT_THAT(refused([&] { FileLock second(path("link.db")); }), HasSubstr("link.db: another process is writing"));
  }
  const pid_t child = ::fork();
  if (child == 0) {
    const FileLock lock(path("r.db"));
    ::kill(::getpid(), SIGKILL);  // no destructor runs, the lock file stays
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(std::filesystem::exists(path("r.db.lock")));
  const FileLock lock(path("r.db"));
}

}  // namespace
}  // namespace palpate::store
