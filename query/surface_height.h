/// Estimate of the surface height in the voxel that a ray hits from above.
///
/// A stored voxel states that a surface intersects the voxel's cube, and the mean normal of this surface in the cube.
/// The surface is modelled as a plane of this normal that intersects the cube, but not the previous cube along the ray.
/// The estimate is the mean of all planes that meet these conditions. All of these planes lie within half a voxel of
/// the estimate along the ray.
#pragma once

#include <span>
#include <vector>

#include "core/base/rules.h"
#include "query/first_hit/query_ray.h"
#include "query/scene_query.h"

namespace gigabake {

/// The maximum error of a height in voxel edges. It holds for a surface that is flat within a column of voxels.
inline constexpr double height_error_edges = 0.5;

/// Returns the distance at which the ray intersects the estimated surface of the voxel. If the surface is nearly
/// parallel to the ray, returns the middle of the ray's segment in the cube.
/// Range   `hit` is the hit of `ray`; its outcome is QueryOutcome::hit.
double surface_distance(const QueryRay& ray, const QueryHit& hit, SurfaceRule rule);

/// Replaces the distance of each hit, which is the distance to the voxel's cube, by the distance to the estimated
/// surface.
///
/// The estimate of a steep surface may lie below the hit voxel. This estimate is used only if all voxels between the
/// hit voxel and the estimate exist. Otherwise, for example for a leaf or the top of a thin wall, the middle of the
/// ray's segment in the hit voxel is used.
/// Exact   The result depends only on the scene's voxels, not on cells, batches or threads.
/// Errors  The same as SceneQuery::first_hits().
void move_to_surface(SceneQuery& query, SurfaceRule rule, std::span<const QueryRay> rays, std::span<QueryHit> hits,
                     const Progress& progress = {});

}  // namespace gigabake
