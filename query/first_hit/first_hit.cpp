#include "query/first_hit/first_hit.h"

#include <algorithm>
#include <vector>

#include "core/base/thread_pool.h"
#include "query/first_hit/first_hit_cast.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t rays_per_range = 1024;

using Stack = FirstHitSlots<1>;

double squared_length(const float v[3]) { return double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2]; }

/// Returns the distance up to which all rays of a tile stay within `reach` of the tile's beam on each axis, in lod-0
/// voxels. `tile` is the tile's edge in pixels.
double beam_limit(const FirstHitCamera& camera, int tile, double reach) {
  double apart = 0;  // max distance between the origins of the beam and of a ray, on an axis
  for (int a = 0; a < 3; ++a)
    apart = std::max(apart, tile * 0.5 *
                                (std::fabs(double(camera.across[a])) * double(camera.per_column) +
                                 std::fabs(double(camera.upward[a])) * double(camera.per_row)));
  // Directions have a length of at least 1 before they are normalized, so normalizing does not spread them further.
  const double spread = tile * 0.5 *
                        std::hypot(std::sqrt(squared_length(camera.right)) * double(camera.per_column),
                                   std::sqrt(squared_length(camera.up)) * double(camera.per_row));
  if (apart >= reach) return 0;
  return spread > 0 ? (reach - apart) / spread : HUGE_VAL;
}

void look_up(const FirstHitView& scene, const FirstHitResult& result, std::size_t i) {
  if (result.attributes.empty()) return;
  const std::uint32_t attributes_index = result.hits[i].attributes_index;
  result.attributes[i] = attributes_index == no_attributes ? VoxelAttributes{} : scene.attributes[attributes_index];
}

}  // namespace

FirstHitBeams plan_beams(const FirstHitView& scene, const FirstHitCamera& camera) {
  constexpr int tile_bits[2] = {2, 3};
  constexpr double max_distance = 32;  // in edges of the tree; up to this distance the slack covers rounding errors
  const FirstHitTree& tree = scene.tree;
  double squared = 0;
  for (int a = 0; a < 3; ++a) squared += (tree.centre[a] - camera.eye[a]) * (tree.centre[a] - camera.eye[a]);
  for (int i = 0; i < 2; ++i) {
    FirstHitBeams beams;
    beams.slack = tree.edge * 0x1p-15f;
    const double limit =
        std::fmin(beam_limit(camera, 1 << tile_bits[i], double(scene.shells[i].reach) - double(beams.slack)),
                  max_distance * double(tree.edge));
    if (scene.shells[i].tree.nodes.empty() || limit < std::sqrt(squared)) continue;
    beams.shell = scene.shells[i].tree;
    beams.tile_bits = tile_bits[i];
    beams.tile = 1 << tile_bits[i];
    beams.columns = (camera.width + beams.tile - 1) / beams.tile;
    beams.rows = (camera.height + beams.tile - 1) / beams.tile;
    beams.limit = float(limit) * (1 - 0x1p-20f);
    return beams;
  }
  return {};
}

void cast_first_hits(const FirstHitView& scene, const FirstHitCamera& camera, const FirstHitResult& result,
                     const ThreadPool& pool) {
  const FirstHitBeams beams = plan_beams(scene, camera);
  const auto columns = std::size_t(beams.columns), width = std::size_t(camera.width);
  std::vector<float> starts(columns * std::size_t(beams.rows));
  pool.parallel_for(starts.size(), rays_per_range, [&](std::size_t begin, std::size_t end, int) {
    std::uint32_t slots[first_hit_stack];
    for (std::size_t i = begin; i < end; ++i)
      starts[i] = beam_start(beams, camera, int(i % columns), int(i / columns), Stack{slots});
  });
  pool.parallel_for(result.hits.size, rays_per_range, [&](std::size_t begin, std::size_t end, int) {
    std::uint32_t slots[first_hit_stack];
    for (std::size_t i = begin; i < end; ++i) {
      const auto x = int(i % width), y = int(i / width);
      const float start =
          beams.tile == 0 ? 0 : starts[std::size_t(y >> beams.tile_bits) * columns + std::size_t(x >> beams.tile_bits)];
      result.hits[i] = pixel_hit(scene.tree, camera, x, y, start, Stack{slots});
      look_up(scene, result, i);
    }
  });
}

void cast_first_hits(const FirstHitView& scene, Span<const FirstHitRay> rays, const FirstHitResult& result,
                     const ThreadPool& pool) {
  pool.parallel_for(rays.size, rays_per_range, [&](std::size_t begin, std::size_t end, int) {
    std::uint32_t slots[first_hit_stack];
    for (std::size_t i = begin; i < end; ++i) {
      result.hits[i] = first_hit(scene.tree, rays[i], 0, Stack{slots});
      look_up(scene, result, i);
    }
  });
}

}  // namespace gigabake::kernels
