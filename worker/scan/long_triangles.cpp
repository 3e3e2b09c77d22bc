#include "worker/scan/long_triangles.h"

#include <algorithm>

#include "worker/pipeline/lattice.h"

namespace gigabake {

bool may_have_long_triangle(const SceneBox& box, const BakeParameters& parameters) {
  if (box.is_empty()) return false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(box.high_m[axis] - box.low_m[axis] < double(max_side_voxels) * parameters.voxel_size_m)) return true;
  return false;
}

std::vector<std::uint32_t> index_without_long(const Primitive& primitive, const Instance& instance,
                                              const BakeParameters& parameters, int lod) {
  const SnapFrame frame = snap_frame(parameters);
  const auto scene_from_local = row_major(instance.scene_from_local);
  std::vector<std::uint32_t> kept;
  kept.reserve(primitive.index.size());
  for (std::size_t at = 0; at + 2 < primitive.index.size(); at += 3) {
    LatticeTriangle triangle;
    bool valid = true;  // the kernels drop invalid triangles
    for (std::size_t i = 0; i < 3; ++i) {
      LatticePoint p{};
      const float* local = primitive.position.data() + 3 * std::size_t(primitive.index[at + i]);
      valid = snap_to_level(frame, scene_from_local.data(), local, lod, p) && valid;
      triangle.p[i] = p.v;
    }
    if (valid && side_of(triangle) > max_triangle_side) continue;
    kept.insert(kept.end(), primitive.index.begin() + std::ptrdiff_t(at),
                primitive.index.begin() + std::ptrdiff_t(at) + 3);
  }
  return kept;
}

}  // namespace gigabake
