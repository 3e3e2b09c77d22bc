#include "bench/flight/mesh_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <meshoptimizer.h>

namespace gigabake::bench {
namespace {

/// A level must have at most this fraction of the triangles of the previous level.
constexpr double max_kept = 0.85;
constexpr std::size_t min_triangles = 8;

TriangleBox box_of(const SourceTriangles& source, std::size_t part) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  TriangleBox box{Vec3d::all(infinite), Vec3d::all(-infinite)};
  for (std::size_t triangle = 0; triangle < source.indices(part).size / 3; ++triangle)
    for (const Vec3d& p : source.corners(part, triangle)) box = {min_by_axis(box.min, p), max_by_axis(box.max, p)};
  return box;
}

/// Returns the triangles with one number for all vertices of equal attributes, without those that become lines.
std::vector<std::uint32_t> merge_vertices(const kernels::PartView& part) {
  const std::size_t vertices = part.position.size / 3;
  std::vector<meshopt_Stream> streams{{part.position.data, 12, 12}};
  if (!part.uv.empty()) streams.push_back({part.uv.data, 8, 8});
  if (!part.rgba.empty()) streams.push_back({part.rgba.data, 8, 8});
  std::vector<unsigned> number(vertices), first(vertices, ~0u);
  meshopt_generateVertexRemapMulti(number.data(), part.index.data, part.index.size, vertices, streams.data(),
                                   streams.size());
  std::vector<std::uint32_t> merged;
  for (std::size_t i = 0; i + 2 < part.index.size; i += 3) {
    std::uint32_t corner[3];
    for (std::size_t k = 0; k < 3; ++k) {
      unsigned& same = first[number[part.index[i + k]]];
      if (same == ~0u) same = part.index[i + k];
      corner[k] = same;
    }
    if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
      merged.insert(merged.end(), corner, corner + 3);
  }
  return merged;
}

bool is_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

bool has_mesh_levels() { return true; }

MeshLevels make_mesh_levels(const SourceTriangles& source, std::size_t part) {
  const Span<const std::uint32_t> index = source.indices(part);
  MeshLevels mesh{box_of(source, part), {{{index.data, index.data + index.size}, 0}}};
  const std::vector<float> position = source.positions(part);
  if (!is_finite(position)) return mesh;
  constexpr std::size_t stride = 3 * sizeof(float);
  const std::vector<std::uint32_t> merged = merge_vertices(source.part(part));
  const double scale = double(meshopt_simplifyScale(position.data(), position.size() / 3, stride));
  for (std::size_t target = merged.size() / 6; target >= min_triangles; target /= 2) {
    MeshLevel level;
    float error = 0;
    level.index.resize(merged.size());
    level.index.resize(meshopt_simplify(level.index.data(), merged.data(), merged.size(), position.data(),
                                        position.size() / 3, stride, 3 * target, 1, meshopt_SimplifyLockBorder,
                                        &error));
    if (level.index.empty() || double(level.index.size()) > max_kept * double(mesh.levels.back().index.size())) break;
    level.error = std::max(scale * double(error), mesh.levels.back().error);
    mesh.levels.push_back(std::move(level));
  }
  return mesh;
}

}  // namespace gigabake::bench
