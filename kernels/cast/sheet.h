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
};

/// What is around a point: the loose surface, and the sheet.
struct CastField {
  CastSample loose;
  CastSheet sheet;
};

/// What does not lie all on a sheet is seen by its coverages too.
GB_HD float loose_part(const CastVoxel& voxel) { return is_all_sheet(voxel.plane) ? 0.0f : 1.0f; }

/// How much of a sheet a voxel holds.
GB_HD float sheet_part(const CastVoxel& voxel) {
  const Plane plane = unpack_plane(voxel.plane);
  return float(plane.coherence * plane.share);
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

GB_HD bool has_sheet(const CastVoxel* voxels, const CastPoint& point) {
  const CastVoxel* corner = voxels + point.base[0] + slot_edge * (point.base[1] + slot_edge * point.base[2]);
  int plane = 0;
  for (int c = 0; c < 8; ++c) plane |= corner[(c & 1) + slot_edge * ((c >> 1 & 1) + slot_edge * (c >> 2))].plane;
  return plane != 0;
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

/// is_wanted: of the level that the ray is on. A brick that stands for finer ones is seen by its coverages alone: its
/// planes may lie on the other side of an eye that is nearer to them than they are wide.
GB_HD CastField field_at(const CastVoxel* voxels, const CastPoint& point, bool is_wanted) {
  if (!is_wanted || !has_sheet(voxels, point)) return {interpolate(voxels, point), {}};
  return {interpolate_parts(voxels, point, [](const CastVoxel& v) { return loose_part(v); }),
          blend_planes(voxels, point)};
}

/// What the sheet looks like: what is loose has no say in it.
GB_HD CastSample sheet_sample(const CastVoxel* voxels, const CastPoint& point) {
  return interpolate_parts(voxels, point, [](const CastVoxel& v) { return sheet_part(v); });
}

/// The share of a voxel's plane that is surface, 0 … 1.
GB_HD float share_of_voxel(const CastVoxel& voxel) {
  if ((voxel.c[3] | voxel.c[4] | voxel.c[5]) == 0) return 0;
  return voxel.plane == 0 ? 1 : float(unpack_plane(voxel.plane).share) * (1.0f / most_share);
}

/// How much of the sheet through a point is surface. Voxels around it stand in four columns along the axis that the
/// sheet is most across; each column has the coverage of its two voxels together, or the larger of their shares where
/// the sheet is so steep that a third voxel may hold some of it. A column that has none counts where the tangent plane
/// passes its two voxels well inside: elsewhere the sheet may be in the next one.
GB_HD float opacity_of_sheet(const CastVoxel* voxels, const CastPoint& point, const CastSheet& sheet) {
  int along = 0;
  for (int a = 1; a < 3; ++a)
    if (std::fabs(sheet.normal[a]) > std::fabs(sheet.normal[along])) along = a;
  const int u = along == 0 ? 1 : 0, v = along == 2 ? 1 : 2;
  const int step[3] = {1, slot_edge, slot_edge * slot_edge};
  const CastVoxel* base = voxels + point.base[0] + slot_edge * (point.base[1] + slot_edge * point.base[2]);
  float there = 0, met = 0;
  for (int column = 0; column < 4; ++column) {
    const int i = column & 1, j = column >> 1;
    const float weight =
        (i != 0 ? point.between[u] : 1 - point.between[u]) * (j != 0 ? point.between[v] : 1 - point.between[v]);
    const float rise =
        sheet.normal[u] * (float(i) - point.between[u]) + sheet.normal[v] * (float(j) - point.between[v]);
    const float at = point.between[along] - rise / sheet.normal[along];  // 0, 1: centres of the column's voxels
    const CastVoxel* low = base + i * step[u] + j * step[v];
    const CastVoxel& high = low[step[along]];
    const float together = float(low->c[3 + along] + high.c[3 + along]) * (1.0f / 65535);
    const float below = at < 1 ? share_of_voxel(*low) : 0, above = at > 0 ? share_of_voxel(high) : 0;
    const float steep = below > above ? below : above, level = together < 1 ? together : 1;
    const float share = level > steep ? level : steep;
    there += weight * share;
    if (share > 0 || (at > -1.0f / 6 && at < 7.0f / 6)) met += weight;
  }
  return met > 0 ? there / met : 1;
}

}  // namespace gigabake::kernels
