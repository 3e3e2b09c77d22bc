/// Layout of a texture's scratch file: a header, then the levels from the finest to the coarsest.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/body/texture/texture_view.h"
#include "worker/tiles/texture_file.h"

namespace gigabake {

struct TextureHead {
  static constexpr std::uint64_t right_magic = 0x7865747462676267;  // "gbgbttex"

  std::uint64_t magic = right_magic, bytes = 0, checksum = 0;
  std::uint32_t version = texture_file_version;
  std::int32_t width = 0, height = 0, levels = 0;
  std::uint32_t mask_cutoff = 0, is_opaque = 0, unused[2] = {};

  std::uint64_t row_bytes(int level) const {
    return std::uint64_t(kernels::level_extent(width, level)) * (level == 0 ? 4 : 8);
  }
  std::uint64_t level_bytes(int level) const {
    return row_bytes(level) * std::uint64_t(kernels::level_extent(height, level));
  }
  /// Returns the total size of levels [0, end) in bytes.
  std::uint64_t bytes_before(int end) const {
    std::uint64_t sum = 0;
    for (int l = 0; l < end; ++l) sum += level_bytes(l);
    return sum;
  }
};
static_assert(sizeof(TextureHead) == 56 && sizeof(TextureHead) % alignof(std::uint16_t) == 0);

/// Returns the checksum of header and levels. `level_hashes` holds XXH3_64bits of each level's bytes. Separate hashes
/// allow rows of different levels to be written alternately.
std::uint64_t checksum_of(TextureHead head, std::span<const std::uint64_t> level_hashes);

}  // namespace gigabake
