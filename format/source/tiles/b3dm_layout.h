/// Layout of a "Batched 3D Model": the lengths of its parts, from the four words behind the total length.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

/// Bytes of four parts in the order of the file: JSON and binary part of the feature table, then of the batch table.
using TableLengths = std::array<std::uint32_t, 4>;

struct B3dmLayout {
  std::uint32_t header_bytes = 28;  ///< the tables follow, then the glTF
  TableLengths table_bytes{};
};

/// Returns the layout. Headers of versions before 1.0 have only two or three numbers. The next word is then text:
/// "glTF" or the beginning of a JSON. Text that is read as a number is larger than any length.
/// Source  3D Tiles 1.0; CesiumJS, B3dmParser.
inline B3dmLayout b3dm_layout(const std::array<std::uint32_t, 4>& words) {
  constexpr std::uint32_t min_text = 0x22000000;
  if (words[2] >= min_text) return {20, {0, 0, words[1], 0}};         // batch length, batch table
  if (words[3] >= min_text) return {24, {0, 0, words[0], words[1]}};  // batch table, its binary part, batch length
  return {28, words};
}

}  // namespace gigabake
