/// The surface of filled voxels.
///
/// A filled voxel with a neighbour outside the shape, of its 26, is on the surface of the shape. Its normal is the sum
/// of the offsets to these neighbours, and its plane goes through its centre. If the sum is zero, the voxel has the
/// normal (0, 0, 1) and no plane. All other voxels are inside, and have no plane. The normal of an inner voxel is that
/// of the face of the box around the shape whose pyramid, with its apex in the middle of the box, contains the voxel;
/// of equal faces, those along z come first, then those along y.
///
/// Exact   Integers, except for the octahedral code of the normal: IEEE double.
#pragma once

#include <array>
#include <cstdint>

#include "format/edit/edits_in_scene.h"

namespace gigabake {

struct FilledSurface {
  std::array<std::int8_t, 2> normal{};
  std::uint8_t plane = 0;
};

/// The filled voxels of a brick.
class FilledBrick {
 public:
  /// `selected` has the voxels of the brick that the edit selects; `min` is its lowest voxel.
  FilledBrick(const EditsInScene& edits, std::uint32_t edit, const Vec3i64& min, const BrickMask& selected);

  /// Returns the surface of a selected voxel. `at` is its position in the brick.
  FilledSurface surface(const Vec3<int>& at) const;

 private:
  static constexpr int edge_ = brick_edge + 2;
  static std::size_t index(const Vec3<int>& at) {
    return std::size_t((at[0] + 1) + edge_ * ((at[1] + 1) + edge_ * (at[2] + 1)));
  }
  void find_neighbours(const EditsInScene& edits, std::uint32_t edit, const BrickMask& selected);

  Vec3i64 min_, middle_, half_;
  bool is_inner_ = false;                                               ///< no voxel is on the surface
  std::array<bool, std::size_t(edge_) * edge_ * edge_> is_selected_{};  ///< of the brick and its neighbours
};

}  // namespace gigabake
