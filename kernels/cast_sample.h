/// The field that rays integrate: the eight voxels around a point of one level, interpolated.
///
/// The eight may stand in up to eight bricks, of several cells; each is looked up where it is, so that the field is
/// continuous across bricks and cells. Where two columns of cells are not aligned at a level (z above lod 3), a voxel
/// of the other cell stands for the centre that lies in it.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/cast_locate.h"
#include "kernels/cast_scene.h"
#include "kernels/types.h"

namespace gigabake::kernels {

struct CastSample {
  float c[4] = {0, 0, 0, 0};  ///< as CastVoxel, 1 = 1
};

/// Eight voxel centres of one level and where the point lies between them.
struct CastCorners {
  std::int64_t base[3];  ///< lod-0 voxel in the middle of the lowest one
  float between[3];      ///< 0…1
};

GB_HD CastCorners corners_around(const double p[3], int lod, const std::int64_t aligned_with[3]) {
  CastCorners r;
  const std::int64_t edge = std::int64_t(1) << lod;
  const double per_edge = 1.0 / double(edge);
  for (int a = 0; a < 3; ++a) {
    const std::int64_t phase = aligned_with[a] & (edge - 1);
    const double u = (p[a] - double(phase)) * per_edge - 0.5, low = std::floor(u);
    r.base[a] = std::int64_t(low) * edge + phase + edge / 2;
    r.between[a] = float(u - low);
  }
  return r;
}

GB_HD std::uint32_t voxels_before(const CastBrick& brick, int z) {
  return z == 0 ? 0 : std::uint32_t(brick.before >> (9 * (z - 1)) & 511);
}

/// Range  x, y, z: 0 … 7.
GB_HD CastVoxel voxel_of(const CastBrick& brick, const CastVoxel* voxels, int x, int y, int z) {
  const std::uint64_t word = brick.mask[z];
  const int bit = x + 8 * y;
  if ((word >> bit & 1) == 0) return CastVoxel{{0, 0, 0, 0}};
  const int below = count_bits(word & ((std::uint64_t(1) << bit) - 1));
  return voxels[brick.first + voxels_before(brick, z) + std::uint32_t(below)];
}

/// v must be in the place's box.
GB_HD CastVoxel value_at(const CastPlace& place, int lod, const std::int64_t v[3]) {
  if (place.constant != nullptr) return *place.constant;
  if (place.brick == nullptr) return CastVoxel{{0, 0, 0, 0}};
  return voxel_of(*place.brick, place.voxels, int((v[0] - place.min[0]) >> lod), int((v[1] - place.min[1]) >> lod),
                  int((v[2] - place.min[2]) >> lod));
}

/// x first, then y, then z.
GB_HD CastSample interpolate(const CastVoxel corner[8], const float between[3]) {
  CastSample r;
  for (int k = 0; k < 4; ++k) {
    float row[4];
    for (int i = 0; i < 4; ++i) {
      const float low = corner[2 * i].c[k], high = corner[2 * i + 1].c[k];
      row[i] = low + (high - low) * between[0];
    }
    const float near = row[0] + (row[1] - row[0]) * between[1], far = row[2] + (row[3] - row[2]) * between[1];
    r.c[k] = (near + (far - near) * between[2]) * (1.0f / 65535);
  }
  return r;
}

/// All eight in one brick, whose lowest is voxel (x,y,z) of it; each at most 6. False where none of them is there.
GB_HD bool corners_in_brick(const CastBrick& brick, const CastVoxel* voxels, int x, int y, int z, CastVoxel corner[8]) {
  const int bit = x + 8 * y;
  if (((brick.mask[z] | brick.mask[z + 1]) >> bit & 0x303) == 0) return false;
  for (int c = 0; c < 8; ++c) corner[c] = voxel_of(brick, voxels, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
  return true;
}

/// The eight from wherever they are; `there` remembers the latest place besides `here`, for the next point.
/// Bits of `crossing`: the axes along which the two sides do not both lie in `here`.
/// seen: whether any of them may be there. Returns the page that is missing, or no_page.
GB_HD std::uint32_t gather_corners(const CastScene& scene, int lod, const CastCorners& around, const CastPlace& here,
                                   CastPlace& there, unsigned crossing, CastVoxel corner[8], bool& seen) {
  const std::int64_t edge = std::int64_t(1) << lod;
  for (unsigned group = 0;; group = (group - crossing) & crossing) {
    for (unsigned c = 0; c < 8; ++c) {
      if ((c & crossing) != group) continue;
      const std::int64_t v[3] = {around.base[0] + (c & 1 ? edge : 0), around.base[1] + (c & 2 ? edge : 0),
                                 around.base[2] + (c & 4 ? edge : 0)};
      const bool is_here = here.contains(v);
      if (!is_here && !there.contains(v)) there = locate(scene, lod, v, here);
      const CastPlace& place = is_here ? here : there;
      if (place.missing != no_page) return place.missing;
      seen |= !place.empty();
      corner[c] = value_at(place, lod, v);
    }
    if (group == crossing) return no_page;
  }
}

/// The field at p; zero where nothing is near. `here`: the place of p; `there`: see gather_corners(). Returns the page
/// that is missing, or no_page.
GB_HD std::uint32_t sample_field(const CastScene& scene, int lod, const double p[3], const CastPlace& here,
                                 CastPlace& there, CastSample& sample) {
  const CastCorners around = corners_around(p, lod, here.cell_min);
  const std::int64_t edge = std::int64_t(1) << lod;
  unsigned crossing = 0;
  for (int a = 0; a < 3; ++a)
    if (around.base[a] < here.min[a] || around.base[a] + edge >= here.max[a]) crossing |= 1u << a;
  CastVoxel corner[8];
  if (crossing != 0) {
    bool seen = false;
    const std::uint32_t missing = gather_corners(scene, lod, around, here, there, crossing, corner, seen);
    if (missing != no_page || !seen) return missing;
  } else if (here.brick != nullptr) {
    if (!corners_in_brick(*here.brick, here.voxels, int((around.base[0] - here.min[0]) >> lod),
                          int((around.base[1] - here.min[1]) >> lod), int((around.base[2] - here.min[2]) >> lod),
                          corner))
      return no_page;
  } else {
    const CastVoxel all = here.constant != nullptr ? *here.constant : CastVoxel{{0, 0, 0, 0}};
    for (CastVoxel& c : corner) c = all;
  }
  sample = interpolate(corner, around.between);
  return no_page;
}

}  // namespace gigabake::kernels
