// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <palpate/recording/output_file.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

class OutputFileTest : public test::TemporaryFolder {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path("")), {}));
  }
};

TEST_F(OutputFileTest, CommitPutsTheWholeFileInPlace) {
  write("e.csv", "old");
  OutputFile out(path("e.csv"));
  out.write("new,");
  out.write("text\n");
  EXPECT_EQ(contents(path("e.csv")), "old");
  out.commit();
  EXPECT_EQ(contents(path("e.csv")), "new,text\n");
  EXPECT_EQ(files(), 1u);
  EXPECT_EQ(error_of([&] { out.write("more"); }), "e.csv: cannot be written: Bad file descriptor");
}

TEST_F(OutputFileTest, WithoutCommitNothingStays) {
  write("e.csv", "old");
  { OutputFile(path("e.csv")).write("half"); }
  { OutputFile(path("new.csv")).write("half"); }
  EXPECT_EQ(contents(path("e.csv")), "old");
  EXPECT_EQ(files(), 1u);
}

TEST_F(OutputFileTest, ALinkStaysALink) {
  std::filesystem::create_symlink(write("e.csv", "old"), path("link.csv"));
  OutputFile out(path("link.csv"));
  out.write("new");
  out.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(path("link.csv")));
  EXPECT_EQ(contents(path("e.csv")), "new");
}

TEST_F(OutputFileTest, FailuresNamePathAndReason) {
  EXPECT_EQ(error_of([&] { OutputFile out(path("absent/e.csv")); }),
            "absent/e.csv: cannot be written: No such file or directory");
  const std::string folder = error_of([&] { OutputFile out(path("")); });
  EXPECT_TRUE(folder.ends_with("cannot be written: Is a directory")) << folder;
}

TEST_F(OutputFileTest, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  EXPECT_EQ(error_of([&] {
              OutputFile out("/dev/full");
              out.write("text");
              out.commit();
            }),
            "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

}  // namespace
}  // namespace palpate
