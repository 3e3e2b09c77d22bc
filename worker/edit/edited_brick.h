/// One brick of lod 0 while edits are applied to it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "format/edit/edits_in_scene.h"
#include "kernels/body/cell.h"

namespace gigabake {

/// A brick of lod 0, without voxels at first.
class EditedBrick {
 public:
  /// `min` is the lowest voxel of the brick.
  EditedBrick(const EditsInScene& edits, const Vec3i64& min, const kernels::CellParameters& parameters)
      : edits_(edits), min_(min), parameters_(parameters) {}

  /// Takes the voxels of brick `index` of a level.
  void load(const kernels::Level& level, std::size_t index);
  /// Applies edits in their order. Returns whether any of them selects a voxel that it may change.
  bool apply(std::span<const std::uint32_t> edits);
  /// Appends the brick to a level, unless it has no voxels.
  void append_to(kernels::Level& level, std::uint64_t key) const;

 private:
  struct Voxel {
    std::array<std::uint8_t, 4> rgba;
    std::array<std::int8_t, 2> normal;
    std::uint8_t plane;
    VoxelClass voxel_class;
  };

  /// Calls visit(word, bit, index) for each voxel of a mask, in the order of a brick's voxels.
  template <class Visit>
  static void for_each(const BrickMask& mask, const Visit& visit);
  BrickMask selected_by(std::uint32_t edit) const;
  void fill(std::uint32_t edit, const BrickMask& selected);
  void paint(const Edit& edit, const BrickMask& selected);

  const EditsInScene& edits_;
  Vec3i64 min_;
  const kernels::CellParameters& parameters_;
  BrickMask mask_{};
  std::array<Voxel, brick_voxels> voxels_;  ///< by word and bit; those outside `mask_` have no value
};

}  // namespace gigabake
