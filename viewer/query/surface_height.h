/// The height of the surface in the voxel that a ray meets from above.
///
/// A stored voxel states that the surface meets its cube, and the mean normal of the surface there. The plane of that
/// normal meets the cube but not the cube before it along the ray. The mean of all such planes is the estimate; the
/// others lie within half a voxel of it along the ray.
#pragma once

#include <span>
#include <vector>

#include "lattice/rules.h"
#include "viewer/query/query_ray.h"
#include "viewer/query/scene_query.h"

namespace gigabake {

/// Bound of the error of a height, in edges of the voxel: exact for a surface that is flat in its voxel column.
inline constexpr double height_error_edges = 0.5;

/// Returns the distance at which the ray meets the estimated surface of the voxel; the middle of the ray's segment in
/// the cube for a surface that is nearly parallel to the ray. Range  hit: of this ray, its outcome is `hit`.
double surface_distance(const QueryRay& ray, const QueryHit& hit, SurfaceRule rule);

/// Replaces the distance of each hit, where the ray enters the cube, by that of the surface.
///
/// A surface is steeper than its top voxel if it continues in the voxels below. The estimate of a steep surface is used
/// only if all voxels down to it exist; otherwise (a leaf, the top of a thin wall) the middle of the top voxel is.
/// Exact   Depends on the scene's voxels only, not on cells, batches or threads.
/// Errors  As SceneQuery::first_hits().
void move_to_surface(SceneQuery& query, SurfaceRule rule, std::span<const QueryRay> rays, std::span<QueryHit> hits,
                     const Progress& progress = {});

}  // namespace gigabake
