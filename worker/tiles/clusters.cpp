#include "worker/tiles/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/octree/morton.h"
#include "kernels/cpu/voxelize/radix_sort.h"

namespace gigabake {
namespace {

constexpr int axis_bits = 10;
constexpr std::uint32_t no_vertex = UINT32_MAX;

/// Returns three times the triangle's centroid.
Vec3d tripled_centroid(const Primitive& mesh, std::size_t triangle) {
  Vec3d sum{};
  for (std::size_t corner = 0; corner < 3; ++corner)
    sum += Vec3d::from(&mesh.position[3 * std::size_t(mesh.index[3 * triangle + corner])]);
  return sum;
}

/// Quantizer of coordinates to 2^axis_bits steps of equal length on all axes.
struct CurveGrid {
  Vec3d low{};
  double steps_per_unit = 0;

  /// Returns the step of a value; clamps values beyond the grid to its border. NaN maps to step 0.
  std::uint32_t step(double value, std::size_t axis) const {
    constexpr double last = (1 << axis_bits) - 1;
    const double at = (value - low[axis]) * steps_per_unit;
    return at > 0 ? std::uint32_t(std::min(at, last)) : 0;
  }
};

/// Fits the grid to the 2nd to 98th percentile of centroids: one vertex with a wrong unit must not put all others into
/// one step.
CurveGrid grid_of(const Primitive& mesh) {
  constexpr std::size_t samples = 1024;
  const std::size_t triangles = mesh.index.size() / 3;
  std::array<std::vector<double>, 3> along;
  for (std::uint64_t i = 0; i < samples; ++i) {
    // The samples are scattered: at a regular stride, all samples could lie in one row of a grid of triangles.
    const std::size_t triangle = std::size_t((i * 0x9e3779b97f4a7c15ull >> 32) * triangles >> 32);
    const Vec3d at = tripled_centroid(mesh, triangle);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isfinite(at[axis])) along[axis].push_back(at[axis]);
  }
  CurveGrid grid;
  double extent = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double>& values = along[axis];
    if (values.empty()) continue;
    std::sort(values.begin(), values.end());
    const double low = values[values.size() / 50], high = values[values.size() - 1 - values.size() / 50];
    const double margin = (high - low) / 10;
    grid.low[axis] = low - margin;
    extent = std::max(extent, high - low + 2 * margin);
  }
  if (extent > 0 && std::isfinite(extent)) grid.steps_per_unit = (1 << axis_bits) / extent;
  return grid;
}

/// Returns the triangles in Morton order; the low 32 bits of each value are the triangle's index.
kernels::UnsetArray<std::uint64_t> along_curve(const Primitive& mesh) {
  const CurveGrid grid = grid_of(mesh);
  kernels::UnsetArray<std::uint64_t> order(mesh.index.size() / 3);
  for (std::size_t t = 0; t < order.size(); ++t) {
    const Vec3d at = tripled_centroid(mesh, t);
    order[t] = morton(grid.step(at[0], 0), grid.step(at[1], 1), grid.step(at[2], 2)) << 32 | t;
  }
  kernels::radix_sort(order, 32, 32 + 3 * axis_bits, callers_thread());
  return order;
}

class ClusterBuilder {
 public:
  explicit ClusterBuilder(const Primitive& mesh) : mesh_(mesh), local_(mesh.position.size() / 3, no_vertex) {
    cluster_.material = mesh_.material;
    cluster_.position_step = mesh_.position_step;
    cluster_.voxel_class = mesh_.voxel_class;
    cluster_.shares_uv = mesh_.shares_uv;
  }

  /// Returns a cluster; the reference is valid until the next call.
  const Primitive& build(std::span<const std::uint64_t> triangles) {
    cluster_.index.clear();
    for (const std::uint64_t t : triangles)
      for (std::size_t corner = 0; corner < 3; ++corner)
        cluster_.index.push_back(local_vertex(mesh_.index[3 * std::size_t(std::uint32_t(t)) + corner]));
    copy_vertices();
    return cluster_;
  }

 private:
  std::uint32_t local_vertex(std::uint32_t vertex) {
    if (local_[vertex] == no_vertex) {
      local_[vertex] = std::uint32_t(used_.size());
      used_.push_back(vertex);
    }
    return local_[vertex];
  }

  void copy_vertices() {
    gather<3>(mesh_.position, cluster_.position);
    gather<2>(mesh_.uv, cluster_.uv);
    gather<4>(mesh_.rgba, cluster_.rgba);
    gather<1>(mesh_.normal, cluster_.normal);
    gather<2>(mesh_.normal_uv, cluster_.normal_uv);
    gather<1>(mesh_.tangent, cluster_.tangent);
    gather<2>(mesh_.id_uv, cluster_.id_uv);
    for (const std::uint32_t vertex : used_) local_[vertex] = no_vertex;
    used_.clear();
  }

  template <std::size_t size, class T>
  void gather(const std::vector<T>& from, std::vector<T>& to) const {
    if (from.empty()) return;
    to.resize(used_.size() * size);
    for (std::size_t i = 0; i < used_.size(); ++i)
      std::copy_n(from.data() + std::size_t(used_[i]) * size, size, to.data() + i * size);
  }

  const Primitive& mesh_;
  std::vector<std::uint32_t> local_;  ///< per vertex of the mesh: its index in the current cluster
  std::vector<std::uint32_t> used_;   ///< vertices of the current cluster
  Primitive cluster_;
};

/// Splits the range at one bit of the Morton code, recursively, until at most cluster_triangles are left. The triangles
/// of a cluster then lie in one octree box; runs of equal length along the curve could include distant triangles.
template <class Visit>
void for_each_box(std::span<const std::uint64_t> along_curve, int bit, const Visit& visit) {
  while (bit < 0 && along_curve.size() > cluster_triangles) {  // all centroids in one step of the grid
    visit(along_curve.first(cluster_triangles));
    along_curve = along_curve.subspan(cluster_triangles);
  }
  if (along_curve.empty()) return;
  if (along_curve.size() <= cluster_triangles) return visit(along_curve);
  const auto middle = std::partition_point(along_curve.begin(), along_curve.end(),
                                           [bit](std::uint64_t v) { return (v >> (32 + bit) & 1) == 0; });
  const std::size_t low = std::size_t(middle - along_curve.begin());
  for_each_box(along_curve.first(low), bit - 1, visit);
  for_each_box(along_curve.subspan(low), bit - 1, visit);
}

}  // namespace

void for_each_cluster(const Primitive& mesh, const std::function<void(const Primitive&)>& visit) {
  if (mesh.index.empty()) return;
  ClusterBuilder builder(mesh);
  const kernels::UnsetArray<std::uint64_t> order = along_curve(mesh);
  for_each_box({order.data(), order.size()}, 3 * axis_bits - 1,
               [&](std::span<const std::uint64_t> triangles) { visit(builder.build(triangles)); });
}

std::vector<Primitive> clusters_of(const Primitive& mesh) {
  std::vector<Primitive> clusters;
  for_each_cluster(mesh, [&](const Primitive& cluster) { clusters.push_back(cluster); });
  return clusters;
}

Primitive joined(std::span<const std::shared_ptr<const Primitive>> clusters) {
  Primitive all;
  std::size_t vertices = 0, corners = 0;
  for (const auto& c : clusters) vertices += c->position.size() / 3, corners += c->index.size();
  if (clusters.empty()) return all;
  all.material = clusters.front()->material;
  all.position_step = clusters.front()->position_step;
  all.voxel_class = clusters.front()->voxel_class;
  all.position.reserve(3 * vertices);
  all.index.reserve(corners);
  if (!clusters.front()->uv.empty()) all.uv.reserve(2 * vertices);
  if (!clusters.front()->rgba.empty()) all.rgba.reserve(4 * vertices);
  if (!clusters.front()->normal.empty()) all.normal.reserve(vertices);
  if (!clusters.front()->normal_uv.empty()) all.normal_uv.reserve(2 * vertices);
  if (!clusters.front()->tangent.empty()) all.tangent.reserve(vertices);
  if (!clusters.front()->id_uv.empty()) all.id_uv.reserve(2 * vertices);
  all.shares_uv = clusters.front()->shares_uv;
  for (const auto& c : clusters) {
    const std::uint32_t first = std::uint32_t(all.position.size() / 3);
    for (const std::uint32_t vertex : c->index) all.index.push_back(first + vertex);
    all.position.insert(all.position.end(), c->position.begin(), c->position.end());
    all.uv.insert(all.uv.end(), c->uv.begin(), c->uv.end());
    all.rgba.insert(all.rgba.end(), c->rgba.begin(), c->rgba.end());
    all.normal.insert(all.normal.end(), c->normal.begin(), c->normal.end());
    all.normal_uv.insert(all.normal_uv.end(), c->normal_uv.begin(), c->normal_uv.end());
    all.tangent.insert(all.tangent.end(), c->tangent.begin(), c->tangent.end());
    all.id_uv.insert(all.id_uv.end(), c->id_uv.begin(), c->id_uv.end());
  }
  return all;
}

}  // namespace gigabake
