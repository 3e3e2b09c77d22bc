/// Layout of a "Batched 3D Model": the begin of each part, from the four numbers behind the length.
#pragma once

#include <array>
#include <cstdint>

namespace gigabake {

/// Bytes of the feature table and of the batch table, JSON and binary part each.
using TableLengths = std::array<std::uint32_t, 4>;

struct B3dmLayout {
  std::uint32_t header_bytes = 28;  ///< the tables follow, then the glTF
  TableLengths table_bytes{};
};

/// Returns the layout. Before 1.0 the header had two or three numbers. A fourth or third word is then text: "glTF" or
/// the beginning of a JSON, which as a number is larger than any length.
/// Source  3D Tiles 1.0; CesiumJS, B3dmParser.
inline B3dmLayout b3dm_layout(const std::array<std::uint32_t, 4>& words) {
  constexpr std::uint32_t min_text = 0x22000000;
  if (words[2] >= min_text) return {20, {0, 0, words[1], 0}};         // batch length, batch table
  if (words[3] >= min_text) return {24, {0, 0, words[0], words[1]}};  // batch table, its binary part, batch length
  return {28, words};
}

}  // namespace gigabake
