#include "worker/tiles/texture_rows.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>
#define XXH_STATIC_LINKING_ONLY
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "kernels/cpu/texture/texture.h"
#include "kernels/cpu/texture/texture_halving.h"
#include "worker/tiles/scratch_publication.h"
#include "worker/tiles/texture_layout.h"

namespace gigabake {
namespace {

constexpr std::size_t written_at_once = std::size_t(256) << 10;
/// Max source rows of one row of the next level. The last source row may also be the first source row of the following
/// row.
constexpr std::size_t rows_held = 3;

/// Buffered, hashed writer of one level.
class LevelSink {
 public:
  LevelSink(ScratchPublication& file, std::uint64_t offset) : file_(file), offset_(offset) {
    XXH3_64bits_reset(&hash_);
  }

  void take(std::span<const std::uint8_t> row) {
    XXH3_64bits_update(&hash_, row.data(), row.size());
    pending_.insert(pending_.end(), row.begin(), row.end());
    if (pending_.size() >= written_at_once) write();
  }
  /// Writes the remaining bytes and returns the hash of all bytes.
  std::uint64_t finish() {
    write();
    return XXH3_64bits_digest(&hash_);
  }

 private:
  void write() {
    file_.put(offset_, pending_);
    offset_ += pending_.size();
    pending_.clear();
  }

  ScratchPublication& file_;
  std::uint64_t offset_;
  std::vector<std::uint8_t> pending_;
  XXH3_state_t hash_;
};

template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& row) {
  return {reinterpret_cast<const std::uint8_t*>(row.data()), row.size() * sizeof(T)};
}

class PyramidWriter {
 public:
  PyramidWriter(ScratchPublication& file, const TextureHead& head, kernels::TextureContent content)
      : file_(file), head_(head), base_texels_(std::uint8_t(head.mask_cutoff), content) {
    for (int l = 0; l < head.levels; ++l) {
      Level level{{kernels::level_extent(head.width, l), kernels::level_extent(head.height, l)},
                  LevelSink(file, sizeof head + head.bytes_before(l))};
      for (auto& row : level.rows) row.resize(l == 0 ? 0 : std::size_t(4) * std::size_t(level.extent.width));
      levels_.push_back(std::move(level));
    }
    for (auto& row : base_rows_) row.resize(head.row_bytes(0));
    head_.is_opaque = 1;
  }

  /// Returns the buffer for the image's next row; call take_base_row() once it is filled.
  std::vector<std::uint8_t>& base_row() { return base_rows_[std::size_t(levels_[0].taken) % rows_held]; }
  void take_base_row() {
    levels_[0].sink.take(base_row());
    if (!kernels::are_opaque(base_row().data(), std::size_t(head_.width), std::uint8_t(head_.mask_cutoff)))
      head_.is_opaque = 0;
    ++levels_[0].taken;
    halve_from(0);
  }

  void finish() {
    std::vector<std::uint64_t> hashes;
    for (Level& level : levels_) hashes.push_back(level.sink.finish());
    head_.checksum = checksum_of(head_, hashes);
    file_.put(0, {reinterpret_cast<const std::uint8_t*>(&head_), sizeof head_});
    file_.publish();
  }

 private:
  struct Level {
    kernels::LevelExtent extent;
    LevelSink sink;
    std::array<std::vector<std::uint16_t>, rows_held> rows = {};  ///< the last rows; empty for level 0
    int taken = 0;
  };

  /// Makes the rows of the next level whose source rows are complete, then the rows of all coarser levels.
  void halve_from(std::size_t l) {
    if (l + 1 == levels_.size()) return;
    const Level& fine = levels_[l];
    Level& coarse = levels_[l + 1];
    while (coarse.taken < coarse.extent.height &&
           kernels::Footprint(fine.extent.height, coarse.extent.height, coarse.taken).last < fine.taken) {
      std::vector<std::uint16_t>& row = coarse.rows[std::size_t(coarse.taken) % rows_held];
      make_row(l, coarse.taken, row.data());
      coarse.sink.take(bytes_of(row));
      ++coarse.taken;
      halve_from(l + 1);
    }
  }

  void make_row(std::size_t l, int y, std::uint16_t* row) const {
    const auto held = [](std::int64_t j) { return std::size_t(j) % rows_held; };
    const Level& fine = levels_[l];
    if (l == 0)
      kernels::halve_row(
          fine.extent, y, [&](std::int64_t j) { return base_rows_[held(j)].data(); }, base_texels_, row);
    else
      kernels::halve_row(
          fine.extent, y, [&](std::int64_t j) { return fine.rows[held(j)].data(); }, kernels::add_linear_texel, row);
  }

  ScratchPublication& file_;
  TextureHead head_;
  const kernels::BaseTexels base_texels_;
  std::vector<Level> levels_;
  std::array<std::vector<std::uint8_t>, rows_held> base_rows_;
};

}  // namespace

void write_texture_rows(const std::filesystem::path& target, ImageRows& image, const TextureFilterKey& filter_key) {
  TextureHead head;
  head.width = std::int32_t(image.size().width), head.height = std::int32_t(image.size().height);
  head.levels = kernels::level_count(head.width, head.height);
  head.mask_cutoff = kernels::effective_cutoff(filter_key.alpha, filter_key.mask_cutoff);
  head.bytes = head.bytes_before(head.levels);
  ScratchPublication file(target);
  file.expect_room(sizeof head + head.bytes);
  PyramidWriter pyramid(file, head, filter_key.content);
  for (std::uint64_t y = 0; y < image.size().height; ++y) {
    std::vector<std::uint8_t>& row = pyramid.base_row();
    image.next(row.data());
    if (filter_key.alpha == kernels::TextureAlpha::ignore) kernels::make_opaque(row.data(), image.size().width);
    pyramid.take_base_row();
  }
  pyramid.finish();
}

}  // namespace gigabake
