#include "worker/tiles/loaded_tile.h"

#include <algorithm>
#include <cmath>
#include <utility>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/source/tile_hash.h"
#include "lattice/error.h"
#include "worker/tiles/clusters.h"

namespace gigabake {
namespace {

/// A mesh of fewer triangles is not worth cutting.
constexpr std::uint64_t least_cut_triangles = 4 * cluster_triangles;

Hash128 hash_of(const std::vector<std::uint8_t>& bytes) {
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  return {h.low64, h.high64};
}

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

TilePrimitive whole(Primitive&& mesh) {
  const LocalBounds bounds = bounds_of(mesh);
  const std::uint64_t triangles = mesh.index.size() / 3;
  return {bounds, triangles, {{bounds, std::make_shared<const Primitive>(std::move(mesh))}}};
}

/// Cells side by side start at multiples of their edge; where a stack of them starts depends on the terrain.
bool reaches_over_cells(const SceneBox& box, const BakeParameters& p) {
  if (box.is_empty()) return false;
  const double edge_m = p.cell_voxels * p.voxel_size_m, margin_m = 2 * p.voxel_size_m;
  const auto cell = [&](double p_scene_m, std::size_t axis) {
    return std::floor((p_scene_m - p.lattice_origin_m[axis]) / edge_m);
  };
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (cell(box.low_m[axis] + margin_m, axis) < cell(box.high_m[axis] - margin_m, axis)) return true;
  return box.high_m[2] - box.low_m[2] > edge_m + 2 * margin_m;
}

}  // namespace

std::shared_ptr<const LoadedTile> LoadedTile::read(const TileRef& tile, const SceneSources& sources,
                                                   const BakeParameters& parameters,
                                                   const std::optional<Hash128>& expected, const ThreadPool& pool) {
  auto loaded = std::make_shared<LoadedTile>();
  loaded->mesh_ = read_tile(tile, sources.root, ReadScope::everything);
  for (Primitive& mesh : loaded->mesh_.primitives) {
    Primitive kept;
    kept.material = mesh.material;
    loaded->primitives_.push_back(whole(std::exchange(mesh, std::move(kept))));
  }
  // Compared after it was read: a file that is replaced meanwhile is caught too.
  if (expected && tile_hash(tile, sources.root) != *expected)
    throw InputError(tile.path, "", "changed while the bake ran; bake again");
  for (const EncodedImage& image : loaded->mesh_.images) loaded->image_hash_.push_back(hash_of(image.bytes));
  loaded->find_boxes(parameters);
  loaded->cut(parameters, pool);
  return loaded;
}

void LoadedTile::find_boxes(const BakeParameters& parameters) {
  boxes_.reserve(mesh_.instances.size());
  for (const Instance& instance : mesh_.instances)
    boxes_.push_back(scene_box(primitives_.at(std::size_t(instance.primitive)).bounds, instance, parameters));
}

void LoadedTile::cut(const BakeParameters& parameters, const ThreadPool& pool) {
  std::vector<char> is_wide(primitives_.size(), 0);
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (reaches_over_cells(boxes_[i], parameters)) is_wide[std::size_t(mesh_.instances[i].primitive)] = 1;
  pool.parallel_for(primitives_.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t p = begin; p < end; ++p) {
      if (is_wide[p] == 0 || primitives_[p].triangles < least_cut_triangles) continue;
      std::vector<Primitive> meshes = clusters_of(*primitives_[p].clusters.front().mesh);
      primitives_[p].clusters.clear();
      for (Primitive& mesh : meshes) {
        const LocalBounds bounds = bounds_of(mesh);
        primitives_[p].clusters.push_back({bounds, std::make_shared<const Primitive>(std::move(mesh))});
      }
    }
  });
}

std::uint64_t LoadedTile::bytes() const {
  std::uint64_t sum = sizeof(*this) + bytes_of(mesh_.instances) + bytes_of(mesh_.materials) + bytes_of(boxes_) +
                      bytes_of(image_hash_) + bytes_of(primitives_);
  for (const TilePrimitive& p : primitives_) {
    sum += bytes_of(p.clusters);
    for (const TileCluster& c : p.clusters)
      sum += sizeof(Primitive) + bytes_of(c.mesh->position) + bytes_of(c.mesh->index) + bytes_of(c.mesh->uv) +
             bytes_of(c.mesh->rgba);
  }
  for (const EncodedImage& image : mesh_.images) sum += sizeof(image) + image.bytes.capacity();
  return sum;
}

}  // namespace gigabake
