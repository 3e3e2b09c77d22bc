#include "query/surface_height.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/math/octahedral.h"
#include "core/octree/plane.h"

namespace gigabake {
namespace {

/// The minimum cosine between plane normal and ray for which the plane is used (a slope of about 86°). This limit also
/// bounds the number of voxels below a hit that are tested (max_steps).
constexpr double min_cosine = 1.0 / 16;
constexpr int max_steps = 32;
/// The depth of the start of a test ray below the top face of the tested voxel, as a fraction of a voxel's edge. This
/// depth is larger than the error of a voxel's faces (QueryTree).
constexpr double inset_edges = 1.0 / 16;

kernels::VoxelBox box_of(const QueryHit& hit) {
  kernels::VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    box.min[a] = hit.voxel[a];
    box.max[a] = hit.voxel[a] + (std::int64_t(1) << hit.lod);
  }
  return box;
}

/// Returns the ray's segment in the voxel. If the ray misses the voxel by a rounding error, the segment is the point of
/// the hit.
RayChord segment_in(const QueryRay& ray, const QueryHit& hit) {
  const RayChord exact = chord_of(ray, box_of(hit), 0);
  return exact.empty() ? RayChord{hit.distance, hit.distance} : exact;
}

double middle_of(const RayChord& segment) { return 0.5 * (segment.enter + segment.leave); }

/// A hit whose estimated surface lies below all voxels of the surface that are known so far.
struct Steep {
  std::uint32_t ray;
  double surface;  ///< distance of the estimated surface
  double middle;   ///< distance of the middle of the hit voxel
  double leave;    ///< distance at which the ray leaves the lowest voxel known so far
  double edge;     ///< edge of the lowest voxel known so far
};

std::vector<QueryRay> rays_below(const std::vector<Steep>& steep, std::span<const QueryRay> rays) {
  std::vector<QueryRay> below;
  for (const Steep& s : steep) {
    QueryRay ray = rays[s.ray];
    ray.begin = s.leave + inset_edges * s.edge;
    ray.end = ray.begin + inset_edges * s.edge;
    below.push_back(ray);
  }
  return below;
}

}  // namespace

double surface_distance(const QueryRay& ray, const QueryHit& hit, SurfaceRule rule) {
  double n[3];
  decode_octahedral(hit.normal, n);
  const double edge = kernels::power_of_two(hit.lod);
  double cosine = 0, sum = 0, maximum = 0, from_centre = 0, advance = 0;
  for (int a = 0; a < 3; ++a) {
    cosine += n[a] * ray.direction[a];
    sum += std::fabs(n[a]);
    maximum = std::fmax(maximum, std::fabs(n[a]));
    from_centre += n[a] * (ray.origin[a] - (double(hit.voxel[a]) + 0.5 * edge));
    advance += std::fabs(ray.direction[a]);
  }
  if (std::fabs(cosine) < min_cosine) return middle_of(segment_in(ray, hit));
  const double side = cosine > 0 ? -1 : 1;  // of the plane that the ray comes from
  from_centre *= side;
  cosine = std::fabs(cosine);
  // A plane intersects a cube if its distance from the centre is at most extent / 2. Under SurfaceRule::thin, a lod-0
  // voxel exists only if the plane intersects one of the voxel's three centre lines, which are parallel to the axes.
  const double extent = rule == SurfaceRule::thin ? sum * (edge - 1) + maximum : sum * edge;
  const double below_centre = 0.5 * (extent - cosine * edge / advance);
  const double middle = (from_centre + below_centre) / cosine;
  const Plane plane = unpack_plane(hit.plane);
  if (plane.coherence == 0) return middle;
  const double above_centre = side * sum * edge * plane.offset / (2 * max_offset);
  const double half_range = height_error_edges * edge / advance;
  return std::clamp((from_centre - above_centre) / cosine, middle - half_range, middle + half_range);
}

void move_to_surface(SceneQuery& query, SurfaceRule rule, std::span<const QueryRay> rays, std::span<QueryHit> hits,
                     const Progress& progress) {
  std::vector<Steep> steep;
  for (std::uint32_t i = 0; i < hits.size(); ++i) {
    if (hits[i].outcome != QueryOutcome::hit) continue;
    const RayChord segment = segment_in(rays[i], hits[i]);
    const double surface = surface_distance(rays[i], hits[i], rule);
    hits[i].distance = std::fmax(surface, segment.enter);
    if (surface > segment.leave)
      steep.push_back({i, surface, middle_of(segment), segment.leave, kernels::power_of_two(hits[i].lod)});
  }
  for (int step = 0; !steep.empty(); ++step) {
    progress.advance(0);  // throws if a stop is requested
    const std::vector<QueryRay> below = rays_below(steep, rays);
    std::vector<QueryHit> found(below.size());
    query.first_hits(below, found);
    std::vector<Steep> left;
    for (std::size_t i = 0; i < steep.size(); ++i) {
      Steep s = steep[i];
      const bool continues = found[i].outcome == QueryOutcome::hit && found[i].distance <= below[i].begin;
      if (continues && step < max_steps) {
        s.leave = std::fmax(segment_in(rays[s.ray], found[i]).leave, below[i].begin);
        s.edge = kernels::power_of_two(found[i].lod);
        if (s.surface > s.leave) left.push_back(s);
        // Rounding of the normal can cause a difference of up to half a voxel.
      } else if (s.surface <= s.leave + height_error_edges * s.edge) {
        hits[s.ray].distance = s.leave;
      } else {
        hits[s.ray].distance = s.middle;
      }
    }
    steep = std::move(left);
  }
}

}  // namespace gigabake
