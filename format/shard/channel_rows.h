/// One channel of one level of an open shard, however its values are stored.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "format/shard/shard_layout.h"
#include "format/shard/stored_rows.h"
#include "format/shard/voxel_channel.h"

namespace gigabake {

class ChannelRows {
 public:
  /// Borrows `source`. bricks, voxels: of the level.
  /// Errors  InputError: the columns do not fit these numbers, or as ColumnSource::open().
  ChannelRows(const ColumnSource& source, const std::string& group, const VoxelChannel& channel, std::uint64_t bricks,
              std::uint64_t voxels);

  const VoxelChannel& channel() const { return channel_; }

  /// Gives each voxel of some bricks, from `brick` on, its value. Any number of threads.
  /// Range   mask: the bricks', as many bits as voxels; first_voxel: of the level, where they begin.
  /// Errors  InputError: `NAME_first` does not count the values, or as StoredRows::read().
  void read(std::uint64_t brick, std::span<const std::uint64_t> mask, std::uint64_t first_voxel, std::uint64_t voxels,
            ChannelBytes<std::uint8_t> to) const;

 private:
  void read_shared(std::uint64_t brick, std::span<const std::uint64_t> mask, ChannelBytes<std::uint8_t> to) const;

  const ColumnSource& source_;
  VoxelChannel channel_;
  ChannelColumns columns_;
  std::unique_ptr<StoredRows> value_, share_, first_;  ///< the last two where values are shared
  std::uint64_t voxels_;
};

}  // namespace gigabake
