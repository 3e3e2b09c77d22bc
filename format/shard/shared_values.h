/// What voxels have in common is stored once: the values of one channel of a level, with what says which voxel has
/// which. The rules: lattice/pack/shared_value.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "format/shard/voxel_channel.h"
#include "lattice/pack/shared_value.h"
#include "lattice/thread_pool.h"

namespace gigabake {

/// Where a level's voxels are: the same for all of its channels.
struct VoxelGroups {
  std::vector<std::uint8_t> of_voxel;  ///< 8·octant + group
  std::vector<std::uint64_t> seen;     ///< of each brick, a bit a group: has voxels
};

/// Range  mask and first as in BrickLevel, consistent.
/// Cost   3 ns of a core a voxel.
VoxelGroups group_voxels(std::span<const std::uint64_t> mask, std::span<const std::uint64_t> first,
                         const ThreadPool& pool);

/// One channel of a level as it is stored: shared by groups where that spares a quarter of the bytes; one value where
/// all voxels are alike. Which voxels share is found at once; the values are copied when somebody asks for them, piece
/// by piece, so that nothing holds all of them.
class SharedValues {
 public:
  /// Borrows groups and voxel_first, of the same level, and bytes. Range  1 ≤ width ≤ widest_value.
  /// Cost  3 to 5 ns of a core a voxel (the sample at 0.0625 m), and as much to collect.
  SharedValues(const VoxelGroups& groups, std::span<const std::uint64_t> voxel_first,
               ChannelBytes<const std::uint8_t> bytes, std::size_t width, const ThreadPool& pool);
  /// Nothing is shared: a value for each of so many voxels.
  SharedValues(ChannelBytes<const std::uint8_t> bytes, std::size_t width, std::size_t voxels);

  std::uint64_t count() const { return count_; }                     ///< of values
  const std::vector<std::uint8_t>& share() const { return share_; }  ///< share_bytes a brick, or empty
  /// With it, bricks+1: where a brick's values begin.
  const std::vector<std::uint64_t>& first() const { return first_; }

  /// As many values, from number `begin` on, as fill `to`. Any number of threads.
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

/// Gives each voxel of the brick its value. mask: 8 words; share: share_bytes; to: as many voxels as mask has bits.
/// False where `value` does not hold as many values of `width` bytes as `share` says; then voxels have any.
bool spread_values(const std::uint64_t* mask, const std::uint8_t* share, std::span<const std::uint8_t> value,
                   std::size_t width, ChannelBytes<std::uint8_t> to);

}  // namespace gigabake
