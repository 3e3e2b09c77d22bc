#include "worker/edit/fill_surface.h"

#include "core/math/octahedral.h"
#include "core/octree/plane.h"

namespace gigabake {
namespace {

bool is_in_brick(const Vec3<int>& at) {
  return at[0] >= 0 && at[0] < brick_edge && at[1] >= 0 && at[1] < brick_edge && at[2] >= 0 && at[2] < brick_edge;
}

std::int64_t magnitude(std::int64_t v) { return v < 0 ? -v : v; }

/// Returns a unit vector along the axis whose pyramid contains `v`, relative to a box with half edges `half`.
Vec3i64 face_normal(const Vec3i64& v, const Vec3i64& half) {
  std::size_t axis = 2;
  for (const std::size_t other : {1, 0})
    if (magnitude(v[other]) * half[axis] > magnitude(v[axis]) * half[other]) axis = other;
  Vec3i64 normal{};
  normal[axis] = v[axis] < 0 ? -1 : 1;
  return normal;
}

std::array<std::int8_t, 2> encoded(const Vec3i64& v) {
  std::array<std::int8_t, 2> code;
  encode_octahedral(double(v[0]), double(v[1]), double(v[2]), code.data());
  return code;
}

}  // namespace

FilledBrick::FilledBrick(const EditsInScene& edits, std::uint32_t edit, const Vec3i64& min, const BrickMask& selected)
    : min_(min), middle_(edits.bounds(edit).min + edits.bounds(edit).end), half_(edits.bounds(edit).size()) {
  const Vec3i64 one = Vec3i64::all(1);
  const Box3i64 brick = Box3i64::cube(min, brick_edge);
  is_inner_ = edits.overlap(edit, {brick.min - one, brick.end + one}) == AreaOverlap::inside;
  if (!is_inner_) find_neighbours(edits, edit, selected);
}

void FilledBrick::find_neighbours(const EditsInScene& edits, std::uint32_t edit, const BrickMask& selected) {
  for (int z = -1; z <= brick_edge; ++z)
    for (int y = -1; y <= brick_edge; ++y)
      for (int x = -1; x <= brick_edge; ++x) {
        const Vec3<int> at{x, y, z};
        is_selected_[index(at)] = is_in_brick(at) ? (selected[std::size_t(z)] >> (x + brick_edge * y) & 1) != 0
                                                  : edits.selects(edit, min_ + Vec3i64(at));
      }
}

FilledSurface FilledBrick::surface(const Vec3<int>& at) const {
  Vec3i64 outward{};
  bool is_on_surface = false;
  for (int n = 0; !is_inner_ && n < 27; ++n) {
    const Vec3<int> offset{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    if (is_selected_[index(at + offset)]) continue;
    is_on_surface = true;
    outward += Vec3i64(offset);
  }
  if (!is_on_surface) {
    const Vec3i64 from_middle = (min_ + Vec3i64(at)) * 2 + Vec3i64::all(1) - middle_;
    return {encoded(face_normal(from_middle, half_)), 0};
  }
  const bool has_plane = outward != Vec3i64{};
  return {encoded(outward), has_plane ? pack_plane({0, max_coherence}) : std::uint8_t(0)};
}

}  // namespace gigabake
