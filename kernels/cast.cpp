#include "kernels/cast.h"

#include "kernels/policy.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t rays_per_range = 512;

template <class Body>
void for_each_ray(const CastScene& scene, const CastCamera& camera, const CastTile& tile, Span<CastRay> rays,
                  const CpuPolicy& policy, const Body& body) {
  policy.parallel_for(rays.size, rays_per_range, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto x = tile.x + int(i % std::size_t(tile.width)), y = tile.y + int(i / std::size_t(tile.width));
      body(line_of_sight(scene, camera, x, y), rays[i]);
    }
  });
}

}  // namespace

void start_rays(const CastScene& scene, const CastCamera& camera, const CastTile& tile, Span<CastRay> rays,
                const CpuPolicy& policy) {
  for_each_ray(scene, camera, tile, rays, policy,
               [&](const CastLine& line, CastRay& ray) { ray = start_ray(scene, line); });
}

void cast_rays(const CastScene& scene, const CastCamera& camera, const CastTile& tile, Span<CastRay> rays,
               const CpuPolicy& policy) {
  for_each_ray(scene, camera, tile, rays, policy, [&](const CastLine& line, CastRay& ray) {
    if (ray.lod >= 0) cast_ray(scene, camera, line, ray);
  });
}

}  // namespace gigabake::kernels
