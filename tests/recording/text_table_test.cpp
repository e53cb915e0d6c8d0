// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <palpate/recording/text_table.hpp>
#include <tests/recording/temporary_folder.hpp>

namespace palpate {
namespace {

class TextTable : public test::TemporaryFolder {};

TEST_F(TextTable, LinesLoseByteOrderMarkAndCarriageReturns) {
  const TextFile file = read_text_file(write("a.csv", "\xEF\xBB\xBFtime_s,x\r\n0,1\r\n1,2"));
  EXPECT_EQ(file.lines, (std::vector<std::string>{"time_s,x", "0,1", "1,2"}));
  EXPECT_FALSE(file.ends_with_newline);
}

TEST_F(TextTable, NumbersAreStrict) {
  EXPECT_EQ(parse_number("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_number("+2"), 2.0);
  for (const char* text : {"nan", "NaN", "NAN", "-nan"})
    EXPECT_TRUE(std::isnan(parse_number(text).value_or(0))) << text;
  for (const char* text : {"inf", "Inf", "INFINITY", "-inf"}) {
    EXPECT_TRUE(std::isinf(parse_number(text).value_or(0))) << text;
  }
  for (const char* text : {"", "abc", "1.5x", "1,5", " 1", "--1", "+-1", "0x10", "1e999"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
  EXPECT_EQ(parse_integer("-7"), -7);
  for (const char* text : {"", "7.0", "nan", "99999999999999999999"}) EXPECT_FALSE(parse_integer(text)) << text;
}

TEST_F(TextTable, Splits) {
  EXPECT_EQ(split(" a ,\tb,", ','), (std::vector<std::string_view>{"a", "b", ""}));
  EXPECT_EQ(split_blank("  1 2\t\t3 "), (std::vector<std::string_view>{"1", "2", "3"}));
  EXPECT_TRUE(split_blank(" ").empty());
}

TEST_F(TextTable, MissingFileEmptyFileAndFolder) {
  EXPECT_EQ(error_of([&] { read_text_file(path("absent.csv")); }),
            "absent.csv: cannot be opened: No such file or directory: expected a readable text file");
  EXPECT_EQ(error_of([&] { read_text_file(write("empty.csv", "\n \n")); }),
            "empty.csv: is empty: expected lines of text");
  EXPECT_EQ(error_of([&] { read_text_file(write("zero.csv", "")); }), "zero.csv: is empty: expected lines of text");
  std::filesystem::create_directory(path("folder"));
  EXPECT_EQ(error_of([&] { read_text_file(path("folder")); }), "folder: is a directory: expected a text file");
}

TEST_F(TextTable, HeaderFaults) {
  const TextFile twice = read_text_file(write("twice.csv", "\na,b,a\n"));
  EXPECT_EQ(error_of([&] { CsvReader csv(twice); }), "twice.csv:2: field header: value 'a': expected each column once");
  const TextFile unnamed = read_text_file(write("unnamed.csv", "a,,c\n"));
  EXPECT_EQ(error_of([&] { CsvReader csv(unnamed); }),
            "unnamed.csv:1: field header: value 'a,,c': expected a name for column 2");
  const TextFile file = read_text_file(write("a.csv", "a,b\n"));
  EXPECT_EQ(error_of([&] { CsvReader(file).require("time_s"); }),
            "a.csv:1: field header: value 'a,b': expected a column named time_s");
}

std::string read_rows(const TextFile& file) {
  CsvReader csv(file);
  while (csv.next()) csv.number(1);
  return "read";
}

TEST_F(TextTable, RowFaults) {
  const TextFile few = read_text_file(write("few.csv", "a,b,c\n1,2,3\n4,5\n6,7,8\n"));
  EXPECT_EQ(error_of([&] { read_rows(few); }), "few.csv:3: field row: value '4,5': expected 3 fields, found 2");
  const TextFile many = read_text_file(write("many.csv", "a,b\n1,2,3\n"));
  EXPECT_EQ(error_of([&] { read_rows(many); }), "many.csv:2: field row: value '1,2,3': expected 2 fields, found 3");
  const TextFile cut = read_text_file(write("cut.csv", "a,b,c\n1,2,3\n4,5"));
  EXPECT_EQ(error_of([&] { read_rows(cut); }),
            "cut.csv:3: field row: value '4,5': expected 3 fields, found 2 (truncated last row)");
  const TextFile words = read_text_file(write("words.csv", "a,b\n1,abc\n"));
  EXPECT_EQ(error_of([&] { read_rows(words); }), "words.csv:2: field b: value 'abc': expected a number");
}

TEST_F(TextTable, MessagesStayOnOneLine) {
  EXPECT_EQ(error_of([&] {
              refuse_field("f", 3, "x",
                           "a\nb\x01"
                           "c",
                           "a number");
            }),
            "f:3: field x: value 'a?b?c': expected a number");
  EXPECT_EQ(printable(std::string(100, 'x')), std::string(80, 'x') + "...");
}

}  // namespace
}  // namespace palpate
