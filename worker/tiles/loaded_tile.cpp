#include "worker/tiles/loaded_tile.h"

#include <cmath>
#include <utility>

#include "worker/tiles/clusters.h"

namespace gigabake {
namespace {

/// Min triangles of a mesh that is worth splitting.
constexpr std::uint64_t min_split_triangles = 4 * cluster_triangles;

template <class T>
std::uint64_t bytes_held(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

/// Returns true if the box spans several cells. In x and y, cells start at multiples of their edge. In z, the start of
/// a column of cells depends on the terrain; the height is therefore compared with the edge of a cell.
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

std::vector<TileCluster> in_memory(std::vector<Primitive>&& meshes) {
  std::vector<TileCluster> clusters;
  for (Primitive& mesh : meshes) {
    const LocalBounds bounds = bounds_of(mesh);
    clusters.push_back({bounds, std::make_shared<const Primitive>(std::move(mesh))});
  }
  return clusters;
}

}  // namespace

LoadedTile::LoadedTile(TileDirectory&& directory, std::shared_ptr<const TileFile> file,
                       const BakeParameters& parameters, const ThreadPool& pool)
    : directory_(std::move(directory)), file_(std::move(file)) {
  boxes_.reserve(mesh().instances.size());
  for (const Instance& instance : mesh().instances)
    boxes_.push_back(scene_box(primitives().at(std::size_t(instance.primitive)).bounds, instance, parameters));
  if (file_ == nullptr) cut(parameters, pool);
}

void LoadedTile::cut(const BakeParameters& parameters, const ThreadPool& pool) {
  std::vector<char> is_wide(primitives().size(), 0);
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (reaches_over_cells(boxes_[i], parameters)) is_wide[std::size_t(mesh().instances[i].primitive)] = 1;
  pool.parallel_for(primitives().size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t p = begin; p < end; ++p) {
      TilePrimitive& primitive = directory_.primitives[p];
      if (is_wide[p] == 0 || primitive.triangles < min_split_triangles) continue;
      primitive.clusters = in_memory(clusters_of(*primitive.clusters.front().mesh));
    }
  });
}

std::shared_ptr<const Primitive> LoadedTile::mesh_of(const TileCluster& cluster) const {
  if (cluster.mesh != nullptr) return cluster.mesh;
  return std::make_shared<const Primitive>(file_->read_cluster(cluster.stored));
}

std::shared_ptr<const Primitive> LoadedTile::mesh_of(const std::vector<const TileCluster*>& clusters) const {
  std::vector<std::shared_ptr<const Primitive>> meshes;
  for (const TileCluster* cluster : clusters) meshes.push_back(mesh_of(*cluster));
  if (meshes.size() < 2) return meshes.empty() ? nullptr : meshes.front();
  return std::make_shared<const Primitive>(joined(meshes));
}

std::shared_ptr<const Primitive> LoadedTile::whole(std::size_t primitive) const {
  std::vector<const TileCluster*> all;
  for (const TileCluster& cluster : primitives()[primitive].clusters) all.push_back(&cluster);
  if (all.empty()) return std::make_shared<const Primitive>();
  return mesh_of(all);
}

EncodedImage LoadedTile::encoded(std::size_t image) const {
  EncodedImage encoded = images()[image].encoded;
  if (file_ != nullptr) encoded.bytes = file_->read(images()[image].stored);
  return encoded;
}

std::uint64_t LoadedTile::bytes() const {
  std::uint64_t sum = sizeof(*this) + bytes_held(mesh().instances) + bytes_held(mesh().materials) + bytes_held(boxes_) +
                      bytes_held(mesh().primitives) + bytes_held(primitives()) + bytes_held(images());
  for (const TilePrimitive& p : primitives()) {
    sum += bytes_held(p.clusters);
    for (const TileCluster& c : p.clusters)
      if (c.mesh != nullptr)
        sum += sizeof(Primitive) + bytes_held(c.mesh->position) + bytes_held(c.mesh->index) + bytes_held(c.mesh->uv) +
               bytes_held(c.mesh->rgba) + bytes_held(c.mesh->normal) + bytes_held(c.mesh->normal_uv) +
               bytes_held(c.mesh->tangent) + bytes_held(c.mesh->id_uv);
  }
  for (const TileImage& image : images()) sum += image.encoded.bytes.capacity();
  return sum;
}

}  // namespace gigabake
