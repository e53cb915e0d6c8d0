// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/mount.h>

#include <map>
#include <palpate/math/errors.hpp>
#include <palpate/session/inspection.hpp>
#include <palpate/session/page_search.hpp>
#include <palpate/store/database.hpp>
#include <tests/recording/temporary_folder.hpp>
#include <tests/session/session_records.hpp>
#include <thread>

namespace palpate::test {
namespace {

using session::LiveRecord;
using session::SessionReader;
using session::SessionWriter;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::size_t kPage = 4096;

class Damaged : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    RandomRecords random(11);
    SessionWriter writer(path("good"), some_catheters(), {.batch_s = 0.01});
    for (int i = 0; i < 1500; ++i) {
      LiveRecord record = random.chance(20) ? random.event("note") : random.frame();
      written_[key(record)] = record;
      while (!writer.offer(record)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      frames_ += record.kind == LiveRecord::Kind::kFrame ? 1 : 0;
    }
    writer.close();
    bytes_ = contents(path("good"));
  }

  static std::int64_t key(const LiveRecord& record) { return record.received_ns; }

  /// Reads `bytes` as a session: every record that comes is one that was written, none comes twice, in order. How many;
  /// -1 where it is refused whole.
  std::int64_t read(const std::string& bytes, std::vector<std::string>& damage) {
    const auto file = write("bad", bytes);
    try {
      SessionReader reader(file);
      std::int64_t last = 0;
      const auto records = read_all(reader);
      for (const LiveRecord& record : records) {
        const auto original = written_.find(key(record));
        EXPECT_NE(original, written_.end()) << key(record);
        EXPECT_GT(key(record), last);
        last = key(record);
        if (original != written_.end() && original->second.kind == record.kind) expect_same(original->second, record);
      }
      damage = reader.damage();
      return static_cast<std::int64_t>(records.size());
    } catch (const InputError& error) {
      damage = {error.what()};
      return -1;
    }
  }
  std::int64_t all() const { return static_cast<std::int64_t>(written_.size()); }

  std::map<std::int64_t, LiveRecord> written_;
  std::string bytes_;
  std::int64_t frames_ = 0;
};

TEST_F(Damaged, NothingIsToldOfAFileThatIsWhole) {
  std::vector<std::string> damage;
  EXPECT_EQ(read(bytes_, damage), all());
  EXPECT_THAT(damage, IsEmpty());
}

/// A page of zeros, of noise, of another page, anywhere but the first.
TEST_F(Damaged, APageThatIsLostCostsItsOwnRowsAndIsNamed) {
  std::mt19937_64 random(12);
  const std::size_t pages = bytes_.size() / kPage;
  std::int64_t worst = all();
  int told = 0, rounds = 0;
  for (std::size_t page = 1; page < pages; page += 1 + pages / 60) {
    std::string bad = bytes_;
    const int kind = static_cast<int>(page % 3);
    for (std::size_t i = 0; i < kPage; ++i)
      bad[page * kPage + i] = kind == 0 ? '\0' : kind == 1 ? static_cast<char>(random()) : bytes_[kPage + i];
    if (bad == bytes_) continue;
    std::vector<std::string> damage;
    const std::int64_t rows = read(bad, damage);
    ++rounds;
    if (rows == all()) continue;  // a page without rows: of an index, or free
    EXPECT_FALSE(damage.empty()) << page;
    const std::string where = fmt::format("page {}, byte {}", page + 1, page * kPage);
    told += std::any_of(damage.begin(), damage.end(),
                        [&](const std::string& line) { return line.find(where) != std::string::npos; })
                ? 1
                : 0;
    if (rows > 0) worst = std::min(worst, rows);
  }
  EXPECT_GE(told, rounds * 8 / 10) << "of " << rounds;
  RecordProperty("fewest_rows", static_cast<int>(worst));
}

TEST_F(Damaged, ABitThatFellIsFoundOrChangesNothing) {
  std::mt19937_64 random(13);
  for (int round = 0; round < 50; ++round) {
    std::string bad = bytes_;
    const std::size_t at = std::uniform_int_distribution<std::size_t>(100, bytes_.size() - 1)(random);
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    std::vector<std::string> damage;
    const std::int64_t rows = read(bad, damage);
    EXPECT_TRUE(rows == all() || !damage.empty()) << at;
  }
}

TEST_F(Damaged, AFileThatIsCutOffIsReadAsFarAsItGoes) {
  std::mt19937_64 random(14);
  std::int64_t half = 0;
  for (int round = 0; round <= 40; ++round) {
    const std::size_t size =
        round == 0 ? bytes_.size() / 2 : std::uniform_int_distribution<std::size_t>(0, bytes_.size() - 1)(random);
    std::vector<std::string> damage;
    const std::int64_t rows = read(bytes_.substr(0, size), damage);
    EXPECT_TRUE(rows == all() || !damage.empty()) << size;
    if (round == 0) half = rows;
  }
  EXPECT_GT(half, all() / 3);
}

/// Other stiffness, other forces: whoever estimates again must know.
TEST_F(Damaged, AChangedCatheterIsNoticed) {
  for (const char* change :
       {"UPDATE catheter SET toml = 'schema = 2'", "UPDATE sensor SET name = 'tiq' WHERE position = 0",
        "DELETE FROM sensor WHERE position = 1"}) {
    std::filesystem::remove(path("bad"));
    std::filesystem::copy(path("good"), path("bad"));
    store::Database(path("bad")).execute(change);
    SessionReader reader(path("bad"));
    read_all(reader);
    EXPECT_THAT(reader.damage(), Contains(HasSubstr("catheter \"catheter 0\": its file or its sensors' names")))
        << change;
  }
}

TEST_F(Damaged, AChangedNumberIsNoticed) {
  std::filesystem::copy(path("good"), path("bad"));
  store::Database(path("bad")).execute("UPDATE estimate SET fx_tip_N = fx_tip_N + 1e-9 WHERE id = 700");
  SessionReader reader(path("bad"));
  EXPECT_EQ(static_cast<std::int64_t>(read_all(reader).size()), all() - 1);
  EXPECT_THAT(reader.damage(), Contains(HasSubstr("frame id 700: is not what was written: table estimate")));
  EXPECT_EQ(reader.lost(), 1);
  EXPECT_FALSE(session::inspect(path("bad")).whole());
}

TEST_F(Damaged, RowsThatWereDeletedAreMissed) {
  std::filesystem::copy(path("good"), path("bad"));
  store::Database(path("bad"))
      .execute(
          "DELETE FROM estimate WHERE id BETWEEN 100 AND 104; DELETE FROM frame WHERE id = 300;"
          "DELETE FROM reading WHERE id = 16 * 1000; DELETE FROM event WHERE id = 3");
  SessionReader reader(path("bad"));
  const auto rows = static_cast<std::int64_t>(read_all(reader).size());
  EXPECT_GE(rows, all() - 8);
  EXPECT_LE(rows, all() - 7);  // frame 1000 may have had no first reading
  EXPECT_THAT(reader.damage(),
              Contains(ContainsRegex("frames id 100 to 104 \\(5\\): is not there: table estimate, page")));
  EXPECT_THAT(reader.damage(), Contains(HasSubstr("frame id 300: is not there: table frame")));
  EXPECT_THAT(reader.damage(), Contains(HasSubstr("event id 3: is not there")));
}

TEST_F(Damaged, AFirstPageThatIsLostIsRefusedInOneLine) {
  std::vector<std::string> damage;
  std::string bad = bytes_;
  std::fill(bad.begin() + 16, bad.begin() + kPage, '\0');
  EXPECT_EQ(read(bad, damage), -1);
  EXPECT_THAT(damage.at(0), HasSubstr("bad: "));
  EXPECT_THAT(damage.at(0), Not(HasSubstr("\n")));
}

/// The way down the tree, by hand, ends at the page that SQLite itself names (dbstat).
TEST_F(Damaged, TheRawSearchFindsThePageThatSqliteKnows) {
  const store::Database database(path("good"), store::OpenMode::kReadOnly);
  const std::int64_t root = database.integer("SELECT rootpage FROM sqlite_schema WHERE name = 'estimate'");
  store::Statement leaf = database.prepare(
      "SELECT pageno, sum(ncell) OVER (ORDER BY path) FROM dbstat WHERE name = 'estimate' AND pagetype = 'leaf'");
  std::int64_t before = 0, leaves = 0;
  while (leaf.step()) {  // leaves in order, each with the number of rows up to its end
    EXPECT_EQ(session::find_page(path("good"), root, before + 1).page, leaf.integer(0));
    EXPECT_EQ(session::find_page(path("good"), root, leaf.integer(1)).page, leaf.integer(0));
    before = leaf.integer(1);
    ++leaves;
  }
  EXPECT_EQ(before, frames_);
  EXPECT_GT(leaves, 100);
}

/// A session that was not closed, in a folder that cannot be written (as root, only a mount is in the way).
TEST_F(Damaged, AnUnclosedSessionIsReadFromAReadOnlyFolder) {
  std::filesystem::create_directories(path("folder"));
  {
    const store::Database keeps_the_log(path("good"));
    keeps_the_log.execute("PRAGMA journal_mode = WAL; UPDATE session SET value = 'changed' WHERE key = 'durability'");
    std::filesystem::copy(path("good"), path("folder/s"));
    std::filesystem::copy(path("good-wal"), path("folder/s-wal"));
  }
  const std::string folder = path("folder").string();
  if (::mount(folder.c_str(), folder.c_str(), nullptr, MS_BIND, nullptr) != 0) GTEST_SKIP() << "may not mount";
  ::mount(nullptr, folder.c_str(), nullptr, MS_BIND | MS_REMOUNT | MS_RDONLY, nullptr);
  {
    SessionReader reader(path("folder/s"));
    EXPECT_EQ(static_cast<std::int64_t>(read_all(reader).size()), all());
    EXPECT_THAT(reader.damage(), IsEmpty());
    EXPECT_EQ(reader.about("durability"), "changed");  // it stands in the log alone
  }
  ::umount(folder.c_str());
}

}  // namespace
}  // namespace palpate::test
