/// One channel of one level of an open shard, independent of how its values are stored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "format/shard/columns/stored_rows.h"
#include "format/shard/columns/voxel_channel.h"
#include "format/shard/shard_layout.h"

namespace gigabake {

class ChannelRows {
 public:
  /// Borrows `source`. `bricks` and `voxels` are the level's counts.
  /// Errors  InputError: the columns do not match these counts. Also the errors of ColumnSource::open().
  ChannelRows(const ColumnSource& source, const std::string& group, const VoxelChannel& channel, std::uint64_t bricks,
              std::uint64_t voxels);

  const VoxelChannel& channel() const { return channel_; }

  /// Decodes the values of all voxels of consecutive bricks, starting at `brick`. Thread-safe.
  /// Range   `mask` has 8 words per brick, with `voxels` bits set in total. `first_voxel` is the index, within the
  ///         level, of the first voxel of `brick`.
  /// Errors  InputError: the channel's column `first` does not match the number of values. Also the errors of
  ///         StoredRows::read().
  void read(std::uint64_t brick, std::span<const std::uint64_t> mask, std::uint64_t first_voxel, std::uint64_t voxels,
            ChannelBytes<std::uint8_t> to) const;

 private:
  void read_shared(std::uint64_t brick, std::span<const std::uint64_t> mask, ChannelBytes<std::uint8_t> to) const;

  const ColumnSource& source_;
  VoxelChannel channel_;
  ChannelColumns columns_;
  std::unique_ptr<StoredRows> value_, share_, first_;  ///< share_ and first_ are null if values are not shared
  std::uint64_t voxels_;
};

}  // namespace gigabake
