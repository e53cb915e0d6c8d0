// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <fstream>
#include <optional>
#include <palpate/session/page_search.hpp>
#include <regex>
#include <vector>

namespace palpate::session {

namespace {

constexpr unsigned kInterior = 0x05;      // of a table's tree; a leaf is 0x0d
constexpr std::size_t kFileHeader = 100;  // on page 1 before the page's own
constexpr int kDeepest = 20;

using Page = std::vector<unsigned char>;

std::uint32_t big_endian(const Page& page, std::size_t at, std::size_t bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes; ++i) value = value << 8U | page[at + i];
  return value;
}

/// Seven bits a byte, the highest says that more follow; the ninth counts whole.
std::optional<std::int64_t> varint(const Page& page, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 9; ++i, ++at) {
    if (at >= page.size()) return std::nullopt;
    if (i == 8) return static_cast<std::int64_t>(value << 8U | page[at]);
    value = value << 7U | (page[at] & 0x7fU);
    if (page[at] < 0x80) break;
  }
  return static_cast<std::int64_t>(value);
}

/// The child page that leads to the row; none where this is no interior page that makes sense.
std::optional<std::int64_t> child(const Page& page, std::size_t start, std::int64_t row_id) {
  if (page[start] != kInterior) return std::nullopt;
  const std::size_t cells = big_endian(page, start + 3, 2);
  for (std::size_t i = 0; i < cells; ++i) {
    const std::size_t pointer = start + 12 + 2 * i;
    if (pointer + 2 > page.size()) return std::nullopt;
    const std::size_t cell = big_endian(page, pointer, 2);
    if (cell + 5 > page.size()) return std::nullopt;
    const auto key = varint(page, cell + 4);
    if (!key) return std::nullopt;
    if (row_id <= *key) return big_endian(page, cell, 4);
  }
  return big_endian(page, start + 8, 4);
}

}  // namespace

PagePlace find_page(const std::filesystem::path& file, std::int64_t root_page, std::int64_t row_id) {
  std::ifstream stream(file, std::ios::binary);
  Page page(kFileHeader);
  if (!stream.read(reinterpret_cast<char*>(page.data()), kFileHeader)) return {};
  const std::size_t stated = big_endian(page, 16, 2);
  const std::size_t bytes = stated == 1 ? 65536 : stated;
  if (bytes < 512) return {};
  page.resize(bytes);
  PagePlace place{.page = root_page};
  for (int depth = 0; depth < kDeepest; ++depth) {
    place.offset = (place.page - 1) * static_cast<std::int64_t>(bytes);
    stream.clear();
    stream.seekg(place.offset);
    place.beyond_end = !stream.read(reinterpret_cast<char*>(page.data()), static_cast<std::streamsize>(bytes));
    if (place.beyond_end) return place;
    const auto next = child(page, place.page == 1 ? kFileHeader : 0, row_id);
    if (!next || *next == 0) return place;
    place.page = *next;
  }
  return place;
}

std::string describe(const PagePlace& place) {
  if (place.page == 0) return "no page can be read";
  return fmt::format("page {}, byte {}{}", place.page, place.offset,
                     place.beyond_end ? ", beyond the end of the file" : "");
}

std::string with_offsets(const std::string& text, std::int64_t page_bytes) {
  static const std::regex page("[Pp]age ([0-9]{1,9})");
  std::string out;
  auto rest = text.begin();
  for (std::sregex_iterator match(text.begin(), text.end(), page), end; match != end; ++match) {
    out.append(rest, (*match)[0].second);
    out += fmt::format(" (byte {})", (std::stoll((*match)[1].str()) - 1) * page_bytes);
    rest = (*match)[0].second;
  }
  return out.append(rest, text.end());
}

}  // namespace palpate::session
