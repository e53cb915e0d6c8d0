// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <palpate/link/byte_reader.hpp>
#include <palpate/link/decode.hpp>
#include <utility>

namespace palpate::link {

namespace {

/// One of the four arrays of cells: count times (number of points, their indices), together `bytes` long.
struct CellArray {
  const char* name;
  std::uint32_t count = 0, bytes = 0;
};

using Lines = std::vector<std::vector<std::uint32_t>>;

/// Checks every cell; keeps those of `kept` unless it is null.
std::string read_cells(ByteReader& in, const CellArray& cells, std::uint32_t points, Lines* kept) {
  ByteReader cell(in.take(cells.bytes));
  for (std::uint32_t i = 0; i < cells.count; ++i) {
    const std::uint32_t length = cell.u32();
    if (!cell.ok() || length > cell.left() / 4)
      return fmt::format("{} {}: {} points: expected at most {}", cells.name, i, length, cell.left() / 4);
    if (kept != nullptr) kept->emplace_back().reserve(length);
    for (std::uint32_t k = 0; k < length; ++k) {
      const std::uint32_t index = cell.u32();
      if (index >= points) return fmt::format("{} {}: point {}: expected one of {}", cells.name, i, index, points);
      if (kept != nullptr) kept->back().push_back(index);
    }
  }
  if (cell.left() > 0) return fmt::format("{}: {} bytes behind the last", cells.name, cell.left());
  return {};
}

/// Heads (type, components, number), names that end in a zero, padding to an even length, values.
std::string check_attributes(ByteReader& in, std::uint32_t count) {
  std::uint64_t value_bytes = 0;
  if (count > in.left() / 6) return fmt::format("{} attributes in {} bytes", count, in.left());
  for (std::uint32_t i = 0; i < count; ++i) {
    in.u8();
    const std::uint64_t components = in.u8();
    value_bytes += 4 * components * in.u32();
  }
  std::size_t name_bytes = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::size_t length = 1;
    while (in.ok() && in.u8() != 0) ++length;
    if (!in.ok() || length > 256) return fmt::format("attribute {}: expected a name of at most 255 bytes", i);
    name_bytes += length;
  }
  if (name_bytes % 2 == 1) in.u8();
  if (!in.ok() || value_bytes != in.left())
    return fmt::format("{} bytes of attributes: expected {}", in.left(), value_bytes);
  return {};
}

std::string read_points(ByteReader& in, std::uint32_t count, PolyData& data) {
  if (count > in.left() / 12) return fmt::format("NPOINTS = {}: expected at most {}", count, in.left() / 12);
  data.points_mm.resize(count);
  for (auto& point : data.points_mm)
    for (float& coordinate : point) {
      coordinate = in.f32();
      if (!std::isfinite(coordinate)) return "a point is not finite";
    }
  return {};
}

}  // namespace

std::string decode_polydata(std::span<const std::byte> content, Body& body) {
  ByteReader in(content);
  const std::uint32_t points = in.u32();
  std::array<CellArray, 4> arrays{{{"vertex"}, {"line"}, {"polygon"}, {"strip"}}};
  for (CellArray& cells : arrays) {
    cells.count = in.u32();
    cells.bytes = in.u32();
  }
  const std::uint32_t attributes = in.u32();
  PolyData data;
  if (std::string fault = read_points(in, points, data); !fault.empty()) return fault;
  const bool kept = arrays[1].count <= kMostLines;
  for (const CellArray& cells : arrays) {
    Lines* const lines = &cells == &arrays[1] && kept ? &data.lines : nullptr;
    if (std::string fault = read_cells(in, cells, points, lines); !fault.empty()) return fault;
    if (!in.ok()) return fmt::format("{}s: {} bytes behind the end", cells.name, cells.bytes);
  }
  if (std::string fault = check_attributes(in, attributes); !fault.empty()) return fault;
  if (kept)
    body = std::move(data);
  else
    body = Skipped{"POLYDATA"};
  return {};
}

}  // namespace palpate::link
