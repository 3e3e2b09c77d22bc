/// The sheet around a point: the planes of the eight voxels of one level there, blended.
///
/// Around a point the eight planes' distances are interpolated as colours are, each as much as its voxel is a sheet,
/// and the sheet lies where that distance changes its sign. One function serves both of two neighbours, so their planes
/// meet, and no ray passes between them. Distances are along octahedral normals (kernels/body/plane.h), so they are up
/// to 1.7 times too long; where they are zero, and which side a point is on, is the same.
///
/// Exact   IEEE float: host and device return the same bits.
/// Source  Ohtake et al. 2003, "Multi-level Partition of Unity Implicits"; docs/lab/levels.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/body/plane.h"
#include "kernels/cast/sample.h"
#include "kernels/cast/scene.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

struct CastSheet {
  float sheet = 0;       ///< weight of the voxels that are there · how much they are a sheet, and whole
  float normal[3] = {};  ///< weight · how much they are a sheet · octahedral normal, 127 = 1
  float above = 0;       ///< the same of how far the point lies above their planes; 127: half a voxel

  /// In voxels; 0 where there is no sheet.
  GB_HD float height() const { return sheet > 0 ? above / (sheet * 254) : 0; }

  /// How far a line from the point goes until it meets the sheet, in voxels, if that goes on as it does here; negative:
  /// it comes from there. Far beyond all where the line runs along it. Range  sheet > 0.
  GB_HD double way(const double direction[3]) const {
    double rises = 0;
    for (int a = 0; a < 3; ++a) rises += double(normal[a]) * direction[a];
    return rises == 0 ? 1e30 : double(above) * -0.5 / rises;
  }
};

/// What lets light through hides as much of it whichever way a ray goes through.
struct CastPane {
  float density = 1;  ///< alpha of the voxels of lod 0 that are there; 1 where all are opaque
  float across = 1;   ///< how fast a ray leaves it: 1 is straight across, 0 along it
};

/// What is around a point: the loose surface, and the sheet.
struct CastField {
  CastSample loose;
  CastSheet sheet;
  CastPane pane = {};  ///< of the loose surface
};

/// How much of a sheet a voxel holds: of a corner of one that it barely holds the place is not well known.
GB_HD float sheet_part(const CastVoxel& voxel) {
  const int covered = (voxel.c[3] + voxel.c[4]) + voxel.c[5];
  return float(unpack_plane(voxel.plane).coherence * covered) * (1.0f / (3 * 65535));
}

/// visit(voxel, weight, corner) for the voxels around the point that are there. corner: 0 or 1 along each axis.
template <class Visit>
GB_HD void for_each_corner(const CastVoxel* voxels, const CastPoint& point, const Visit& visit) {
  for (int c = 0; c < 8; ++c) {
    const int corner[3] = {c & 1, c >> 1 & 1, c >> 2};
    const CastVoxel& voxel = voxels[point.base[0] + corner[0] +
                                    slot_edge * (point.base[1] + corner[1] + slot_edge * (point.base[2] + corner[2]))];
    if ((voxel.c[3] | voxel.c[4] | voxel.c[5]) == 0) continue;
    float weight = 1;
    for (int a = 0; a < 3; ++a) weight *= corner[a] != 0 ? point.between[a] : 1 - point.between[a];
    visit(voxel, weight, corner);
  }
}

/// Whether a voxel around the point has that byte.
GB_HD bool any_has(std::uint8_t CastVoxel::*byte, const CastVoxel* voxels, const CastPoint& point) {
  const CastVoxel* corner = voxels + point.base[0] + slot_edge * (point.base[1] + slot_edge * point.base[2]);
  int any = 0;
  for (int c = 0; c < 8; ++c) any |= corner[(c & 1) + slot_edge * ((c >> 1 & 1) + slot_edge * (c >> 2))].*byte;
  return any != 0;
}

/// The length of a vector's part along another one that need not be a unit.
GB_HD float length_along(const double direction[3], const float n[3]) {
  const float squared = (n[0] * n[0] + n[1] * n[1]) + n[2] * n[2];
  if (!(squared > 0)) return 1;
  const double dot = (direction[0] * double(n[0]) + direction[1] * double(n[1])) + direction[2] * double(n[2]);
  return std::fabs(float(dot)) / std::sqrt(squared);
}

GB_HD CastPane pane_at(const CastVoxel* voxels, const CastPoint& point, const double direction[3]) {
  float there = 0, hidden = 0, across = 0;
  for_each_corner(voxels, point, [&](const CastVoxel& voxel, float weight, const int*) {
    const OctahedronPoint n = octahedron_point(voxel.normal);
    const float to[3] = {float(n.c[0]), float(n.c[1]), float(n.c[2])};
    there += weight;
    hidden += weight * voxel.c[3];
    across += weight * length_along(direction, to);
  });
  return there > 0 ? CastPane{hidden / (there * 65535), across / there} : CastPane{};
}

GB_HD CastSheet blend_planes(const CastVoxel* voxels, const CastPoint& point) {
  CastSheet r;
  for_each_corner(voxels, point, [&](const CastVoxel& voxel, float weight, const int corner[3]) {
    if (voxel.plane == 0) return;
    const OctahedronPoint n = octahedron_point(voxel.normal);
    const float by = weight * sheet_part(voxel);
    float above = float(unpack_plane(voxel.plane).offset) * (-127.0f / most_offset);
    for (int a = 0; a < 3; ++a) {
      above += float(2 * n.c[a]) * (point.between[a] - float(corner[a]));
      r.normal[a] += by * float(n.c[a]);
    }
    r.sheet += by;
    r.above += by * above;
  });
  return r;
}

/// Interpolated by weights that are each voxel's own. part(voxel): its weight.
template <class Part>
GB_HD CastSample interpolate_parts(const CastVoxel* voxels, const CastPoint& point, const Part& part) {
  CastSample r;
  for_each_corner(voxels, point, [&](const CastVoxel& voxel, float weight, const int*) {
    const float by = weight * part(voxel) * (1.0f / 65535);
    for (int k = 0; k < cast_channels; ++k) r.c[k] += by * voxel.c[k];
  });
  return r;
}

/// How little a voxel's plane has to do with the sheet around it: 0 where their normals are within 30° of each other, 1
/// beyond 45°. Where two sheets meet, the blended one may lie on neither of them, or nowhere.
GB_HD float disagreement(const OctahedronPoint& n, const CastSheet& sheet) {
  float dot = 0, of_voxel = 0, of_sheet = 0;
  for (int a = 0; a < 3; ++a) {
    dot += float(n.c[a]) * sheet.normal[a];
    of_voxel += float(n.c[a] * n.c[a]);
    of_sheet += sheet.normal[a] * sheet.normal[a];
  }
  if (!(dot > 0)) return 1;
  const float squared = dot * dot, all = of_voxel * of_sheet, left = 3 - 4 * squared / all;
  return left < 0 ? 0 : (left < 1 ? left : 1);
}

/// What is seen by its coverages: what does not lie all on a sheet, and sheets that have little to do with the one that
/// they are blended to. These cover along each axis what their normal says of their largest coverage.
GB_HD CastSample loose_sample(const CastVoxel* voxels, const CastPoint& point, const CastSheet& sheet) {
  CastSample r;
  for_each_corner(voxels, point, [&](const CastVoxel& voxel, float weight, const int*) {
    float by = weight * (1.0f / 65535), along[3] = {1, 1, 1};
    if (is_all_sheet(voxel.plane)) {
      const OctahedronPoint n = octahedron_point(voxel.normal);
      by *= disagreement(n, sheet);
      if (by == 0) return;
      const int most = largest_axis(n);
      for (int a = 0; a < 3; ++a) along[a] = std::fabs(float(n.c[a]) / float(n.c[most]));
    }
    const float mean = ((along[0] + along[1]) + along[2]) * (1.0f / 3);
    for (int k = 0; k < 3; ++k) {
      r.c[k] += by * mean * voxel.c[k];
      r.c[3 + k] += by * along[k] * voxel.c[3 + k];
    }
  });
  return r;
}

/// lod: of the brick. is_wanted: it is of the level that the ray is on. A brick that stands for finer ones is seen by
/// its coverages alone: its planes may lie on the other side of an eye that is nearer to them than they are wide.
GB_HD CastField field_at(const CastVoxel* voxels, const CastPoint& point, int lod, bool is_wanted,
                         const double direction[3]) {
  if (lod == 0) {
    const bool is_clear = any_has(&CastVoxel::clear, voxels, point);
    return {interpolate(voxels, point), {}, is_clear ? pane_at(voxels, point, direction) : CastPane{}};
  }
  if (!is_wanted || !any_has(&CastVoxel::plane, voxels, point)) return {interpolate(voxels, point), {}, {}};
  const CastSheet sheet = blend_planes(voxels, point);
  return {loose_sample(voxels, point, sheet), sheet, {}};
}

/// What the sheet looks like: what is loose has no say in it.
GB_HD CastSample sheet_sample(const CastVoxel* voxels, const CastPoint& point) {
  return interpolate_parts(voxels, point, [](const CastVoxel& v) { return sheet_part(v); });
}

/// How much of a sheet over one column of voxels lies in two of them. at: where the sheet meets the column's middle, 0
/// and 1 being the two centres. reach: how far it goes up and down within the column.
GB_HD float part_in_pair(float at, float reach) {
  const float from = at - reach, to = at + reach;
  const float low = from > -0.5f ? from : -0.5f, high = to < 1.5f ? to : 1.5f;
  return high > low ? (high - low) / (2 * reach) : 0;
}

/// How much of a sheet is there, and how much it hides where it is whole.
struct SheetOpacity {
  float opacity = 1, density = 1;
};

/// How full the fullest voxel of a sheet is that is no farther than one and a half from the point along each axis, as
/// far as its brick knows. A border of an opaque sheet has full ones beside it, a pane has none.
GB_HD float fullest_near(const CastVoxel* voxels, const CastPoint& point, int along) {
  int low[3], high[3], most = 0;
  for (int a = 0; a < 3; ++a) {
    low[a] = point.base[a] > 0 ? point.base[a] - 1 : 0;
    high[a] = point.base[a] + 2 < slot_edge ? point.base[a] + 2 : slot_edge - 1;
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const CastVoxel& voxel = voxels[x + slot_edge * (y + slot_edge * z)];
        if (voxel.plane != 0 && voxel.c[3 + along] > most) most = voxel.c[3 + along];
      }
  return float(most) * (1.0f / 65535);
}

/// A plane is known to a fifteenth of a voxel, and its normal to some degrees.
inline constexpr float least_reach = 0.125f;

/// How much of the sheet through a point is surface. Voxels around it stand in four columns along the axis that the
/// sheet is most across. A column's two voxels together hold so much of it as they cover along that axis, which is
/// exact, of what of the tangent plane lies in them: elsewhere the sheet may be in the next one. Where no voxel
/// near is nearly full the sheet lets light through, and is as dense as it is opaque here; else what is missing is its
/// border.
GB_HD SheetOpacity opacity_of_sheet(const CastVoxel* voxels, const CastPoint& point, const CastSheet& sheet) {
  int along = 0;
  for (int a = 1; a < 3; ++a)
    if (std::fabs(sheet.normal[a]) > std::fabs(sheet.normal[along])) along = a;
  const int u = along == 0 ? 1 : 0, v = along == 2 ? 1 : 2;
  const int step[3] = {1, slot_edge, slot_edge * slot_edge};
  const CastVoxel* base = voxels + point.base[0] + slot_edge * (point.base[1] + slot_edge * point.base[2]);
  const float slope_u = sheet.normal[u] / sheet.normal[along], slope_v = sheet.normal[v] / sheet.normal[along];
  const float reach = least_reach + 0.5f * (std::fabs(slope_u) + std::fabs(slope_v));
  float there = 0, met = 0;
  for (int column = 0; column < 4; ++column) {
    const int i = column & 1, j = column >> 1;
    const float weight =
        (i != 0 ? point.between[u] : 1 - point.between[u]) * (j != 0 ? point.between[v] : 1 - point.between[v]);
    const float rise = slope_u * (float(i) - point.between[u]) + slope_v * (float(j) - point.between[v]);
    const float part = part_in_pair(point.between[along] - rise, reach);
    const CastVoxel* low = base + i * step[u] + j * step[v];
    const float together = float(low->c[3 + along] + low[step[along]].c[3 + along]) * (1.0f / 65535);
    there += weight * (together < part ? together : part);
    met += weight * part;
  }
  if (!(met > 0)) return {};
  const float opacity = there / met;
  if (opacity >= 1) return {opacity, 1};
  const float full = 4 * fullest_near(voxels, point, along) - 3;
  return {opacity, full >= 1 ? 1 : (full > 0 ? opacity + (1 - opacity) * full : opacity)};
}

}  // namespace gigabake::kernels
