/// Deduplicated values of one channel of a level, with the map from voxels to values. The rules are in
/// core/codec/shared_value.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/codec/shared_value.h"
#include "format/shard/columns/voxel_channel.h"

namespace gigabake {

/// The octant and group of each voxel of a level. All channels of the level use the same groups.
struct VoxelGroups {
  std::vector<std::uint8_t> of_voxel;  ///< 8·octant + group
  std::vector<std::uint64_t> seen;     ///< per brick; bit 8·octant + group: the group has voxels
};

/// Assigns the voxels of each brick to their groups.
/// Range   `mask` and `first` are the members of a consistent BrickLevel.
/// Cost    3 ns of one core per voxel.
VoxelGroups group_voxels(std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first,
                         const ThreadPool& pool);

/// The stored form of one channel of a level. If all voxels are equal, one value is stored. Otherwise groups share
/// values if that saves a quarter of the bytes.
/// The constructor determines which voxels share a value. collect() copies a range of values on demand, so no complete
/// copy of the values is needed.
class SharedValues {
 public:
  /// Borrows `groups`, `voxel_first` (BrickLevel::first) and `bytes`, all of the same level.
  /// Range   1 ≤ width ≤ max_value_bytes.
  /// Cost    3 to 5 ns of one core per voxel (measured on the sample at 0.0625 m). Collecting all values costs the same
  ///         again.
  SharedValues(const VoxelGroups& groups, std::span<const std::uint64_t> voxel_first,
               ChannelBytes<const std::uint8_t> bytes, std::size_t width, const ThreadPool& pool);
  /// Shares nothing: stores one value per voxel.
  SharedValues(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels);

  std::uint64_t count() const { return count_; }                     ///< number of values
  const std::vector<std::uint8_t>& share() const { return share_; }  ///< share_bytes per brick, or empty
  /// Returns the index of each brick's first value (bricks + 1 entries). Empty if share() is empty.
  const std::vector<std::uint64_t>& first() const { return first_; }

  /// Copies values, starting at value `begin`, until `to` is full. Thread-safe.
  void collect(std::uint64_t begin, std::span<std::uint8_t> to) const;

 private:
  void find(const ThreadPool& pool);
  void collect_shared(std::uint64_t begin, std::span<std::uint8_t> to) const;

  const VoxelGroups* groups_ = nullptr;
  std::span<const std::uint64_t> voxel_first_;
  ChannelBytes<const std::uint8_t> bytes_;
  std::size_t width_;
  std::uint64_t count_;
  std::vector<std::uint8_t> share_;
  std::vector<std::uint64_t> first_;
};

/// Expands the brick's values to its voxels. `mask` has 8 words, `share` has share_bytes, and `to` has one entry per
/// bit set in `mask`. Returns false if the number of values in `value`, of `width` bytes each, differs from the number
/// that `share` implies. The entries of `to` are then unspecified.
bool spread_values(const std::uint64_t* mask, const std::uint8_t* share, std::span<const std::uint8_t> value,
                   std::size_t width, ChannelBytes<std::uint8_t> to);

}  // namespace gigabake
