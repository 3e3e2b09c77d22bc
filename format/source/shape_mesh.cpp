#include "format/source/shape_mesh.h"

#include "core/base/error.h"
#include "format/source/source.h"

namespace gigabake {
namespace {

void add(const Primitive& primitive, const Affine<Scene, Local>& scene_from_local, MeshShape& shape) {
  const auto first = std::uint32_t(shape.positions_m.size());
  for (std::size_t v = 0; v < primitive.position.size(); v += 3) {
    const Point<Scene> p = scene_from_local(
        {double(primitive.position[v]), double(primitive.position[v + 1]), double(primitive.position[v + 2])});
    shape.positions_m.push_back({p.x, p.y, p.z});
  }
  const bool is_mirrored = scene_from_local.linear_determinant() < 0;
  for (std::size_t i = 0; i < primitive.index.size(); i += 3) {
    const std::uint32_t a = first + primitive.index[i], b = first + primitive.index[i + 1],
                        c = first + primitive.index[i + 2];
    shape.triangles.push_back(is_mirrored ? std::array{a, c, b} : std::array{a, b, c});
  }
}

}  // namespace

MeshShape read_shape_mesh(const std::filesystem::path& file, std::optional<UpAxis> up) {
  SourceOptions options;
  options.local = true;
  options.scene_up = up;
  const SceneSources sources = open_sources(file, options);
  MeshShape shape;
  for (const TileRef& tile : sources.tiles) {
    const TileMesh mesh = read_tile(tile, sources.root, ReadScope::positions_only);
    for (const Instance& instance : mesh.instances)
      add(mesh.primitives.at(std::size_t(instance.primitive)), instance.scene_from_local, shape);
  }
  if (shape.triangles.empty()) throw InputError(file, "", "has no triangles");
  return shape;
}

}  // namespace gigabake
