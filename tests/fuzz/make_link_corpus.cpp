// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <tests/link/example_messages.hpp>

/// Writes the seeds of tests/fuzz/corpus/link: `tools/fuzz.sh --corpus`.
namespace palpate::link {
namespace {

void write_seed(const std::filesystem::path& folder, const std::string& name, unsigned char mode,
                const test::Bytes& stream) {
  std::ofstream file(folder / name, std::ios::binary);
  const unsigned char head[] = {mode, 57};
  file.write(reinterpret_cast<const char*>(head), sizeof head);
  file.write(reinterpret_cast<const char*>(stream.data()), static_cast<std::streamsize>(stream.size()));
}

void write_corpus(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  test::Bytes all;
  int number = 0;
  for (Message message : test::example_messages()) {
    write_seed(folder, "v1_" + std::to_string(number), 1, test::encoded(message));
    message.version = 2;
    message.metadata = {{"TransformStatus", "OK"}, {"n", ""}};
    write_seed(folder, "v2_" + std::to_string(number), 3, test::encoded(message));
    encode(message, all);
    ++number;
  }
  write_seed(folder, "all", 0, all);
  write_seed(folder, "skipped", 0, test::raw_message("IMAGE", test::Bytes(100)));
}

}  // namespace
}  // namespace palpate::link

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: make_link_corpus FOLDER\n"), 2;
  palpate::link::write_corpus(argv[1]);
}
