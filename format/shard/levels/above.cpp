#include "format/shard/levels/above.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <xxhash.h>

#include "format/shard/check/broken_rule.h"

namespace gigabake {

Hash128 hash_of(const DownsampleState& above) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  const auto add = [&state](const auto& column) { XXH3_128bits_update(&state, column.data(), column.size()); };
  add(above.place), add(above.rgba), add(above.normal), add(above.raster), add(above.patch);
  XXH3_128bits_update(&state, above.voxel_class.data(), above.voxel_class.size() * sizeof(VoxelClass));
  const XXH128_hash_t h = XXH3_128bits_digest(&state);
  return {h.low64, h.high64};
}

void check_above(const std::filesystem::path& path, const ShardHeader& header, const DownsampleState& above) {
  const BrokenRule table{path, "/above"};
  const std::size_t voxels = above.voxels();
  table.expect(voxels > 0 && above.place.size() == source_place_bytes * voxels &&
                   above.normal.size() == (header.has_normals ? 2 * voxels : 0) &&
                   above.voxel_class.size() == (header.has_classes ? voxels : 0),
               0, "columns differ in length");
  std::size_t coarsest = 0;
  for (std::size_t v = 0; v < voxels; ++v) {
    const std::uint8_t* place = &above.place[source_place_bytes * v];
    table.expect(place[0] <= 1 && (place[0] == 1 || coarsest == v), v, "the coarsest level does not come first");
    table.expect(std::all_of(place + 1, place + 4, [&](std::uint8_t x) { return x < brick_edge << place[0]; }), v,
                 "a position outside its level");
    table.expect(above.rgba[4 * v + 3] != 0, v, "a voxel without coverage");
    coarsest += place[0] == 0;
  }
  const std::size_t raster = raster_bytes(int(header.first_lod + header.lods) - 1);
  table.expect(above.raster.empty() || above.raster.size() == raster * coarsest, 0,
               "raster does not have one row per voxel");
  table.expect(above.patch.empty() || above.patch.size() == source_patch_bytes * coarsest, 0,
               "patch does not have one row per voxel");
}

}  // namespace gigabake
