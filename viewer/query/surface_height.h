/// Estimate of the surface height in the voxel that a ray hits from above.
///
/// A stored voxel states that the surface intersects its cube, and the mean normal of the surface in it. The plane of
/// that normal intersects the cube but not the previous cube along the ray. The mean of all such planes is the
/// estimate; the other planes lie within half a voxel of it along the ray.
#pragma once

#include <span>
#include <vector>

#include "core/base/rules.h"
#include "kernels/first_hit/query_ray.h"
#include "viewer/query/scene_query.h"

namespace gigabake {

/// Max. error of a height in voxel edges; holds for a surface that is flat in its voxel column.
inline constexpr double height_error_edges = 0.5;

/// Returns the distance at which the ray intersects the estimated surface of the voxel. If the surface is nearly
/// parallel to the ray, returns the middle of the ray's segment in the cube.
/// Range   hit: of this ray; its outcome is `hit`.
double surface_distance(const QueryRay& ray, const QueryHit& hit, SurfaceRule rule);

/// Replaces the distance of each hit, at which the ray enters the cube, by the distance of the surface.
///
/// A surface is steeper than its top voxel if it continues in the voxels below. The estimate of a steep surface is used
/// only if all voxels down to the estimate exist. Otherwise (a leaf, the top of a thin wall) the middle of the top
/// voxel is used.
/// Exact   Depends only on the scene's voxels, not on cells, batches or threads.
/// Errors  The same as SceneQuery::first_hits().
void move_to_surface(SceneQuery& query, SurfaceRule rule, std::span<const QueryRay> rays, std::span<QueryHit> hits,
                     const Progress& progress = {});

}  // namespace gigabake
