#include "bake_scene.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/base/thread_pool.h"
#include "core/octree/brick.h"
#include "core/octree/octree.h"

namespace gigabake::reference {

using namespace gigabake::kernels;
namespace {

constexpr std::int64_t float_exact = std::int64_t(1) << 24;

template <class T>
Span<const T> span_of(const std::vector<T>& v) {
  return {v.data(), v.size()};
}

PartView view_of(const Part& part) {
  PartView view;
  view.position = span_of(part.position);
  view.index = span_of(part.index);
  view.uv = span_of(part.uv);
  view.rgba = span_of(part.rgba);
  std::copy(part.scene_from_local.begin(), part.scene_from_local.end(), view.scene_from_local);
  view.material = part.material;
  view.voxel_class = part.voxel_class;
  view.lod = part.lod;
  if (part.id_texture.texture >= 0) view.id_texture = &part.id_texture;
  view.id_uv = span_of(part.id_uv);
  return view;
}

bool fits_floats(const Triangle& t) {
  for (int k = 1; k < 3; ++k)
    for (const std::int64_t distance : t[k] - t[0])
      if (std::abs(distance) >= float_exact) return false;
  return true;
}

Part triangle_part(const LatticeVertex& origin, const std::array<float, 9>& position) {
  Part part;
  part.position.assign(position.begin(), position.end());
  part.index = {0, 1, 2};
  for (int r = 0; r < 3; ++r) part.scene_from_local[4 * r + 3] = double(origin[r]);
  return part;
}

/// Returns a part whose vertices are unit vectors. The columns of its map are the triangle's vertices minus an origin,
/// so that large integers stay exact. The origin lies behind the triangle, so that the map does not mirror.
Part wide_triangle_part(const Triangle& t) {
  const auto n = normal_of(t);
  int w = 0;
  for (int r = 1; r < 3; ++r)
    if (abs(n[r]) > abs(n[w])) w = r;
  LatticeVertex origin = t[0];
  origin[w] -= sgn(n[w]) * (std::int64_t(1) << 30);
  Part part = triangle_part(origin, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  for (int k = 0; k < 3; ++k)
    for (int r = 0; r < 3; ++r) part.scene_from_local[4 * r + k] = double(t[k][r] - origin[r]);
  return part;
}

Voxel morton_decode(std::uint64_t key) {
  Voxel v{};
  for (int bit = 0; bit < 63; ++bit) v[bit % 3] |= std::int64_t(key >> bit & 1) << (bit / 3);
  return v;
}

void expand_brick(const Level& level, std::size_t brick, const Voxel& corner, VoxelMap& out) {
  std::size_t at = level.first[brick];
  for (int bit = 0; bit < brick_voxels; ++bit) {
    if (!(level.mask[8 * brick + bit / 64] >> (bit % 64) & 1)) continue;
    BakedVoxel value;
    std::copy_n(&level.rgba[4 * at], 4, value.rgba.begin());
    if (!level.normal.empty()) std::copy_n(&level.normal[2 * at], 2, value.normal.begin());
    if (!level.directional_coverage.empty())
      std::copy_n(&level.directional_coverage[directional_coverage_bytes * at], directional_coverage_bytes,
                  value.directional_coverage.begin());
    if (!level.voxel_class.empty()) value.voxel_class = level.voxel_class[at];
    out[{corner[0] + bit % 8, corner[1] + bit / 8 % 8, corner[2] + bit / 64}] = value;
    ++at;
  }
}

void expand_constant(const NodeTable& nodes, std::size_t node, const Voxel& corner, std::int64_t edge, int lod,
                     VoxelMap& out) {
  BakedVoxel value;
  for (int c = 0; c < 4; ++c) value.rgba[c] = std::uint8_t(nodes.value[node] >> (8 * c));
  if (!nodes.normal.empty()) value.normal = nodes.normal[node];
  if (!nodes.voxel_class.empty()) value.voxel_class = nodes.voxel_class[node];
  if (lod > 0) value.directional_coverage = nodes.directional_coverage[node];
  if (lod == 0 && nodes.has_finest_planes)
    value.directional_coverage = finest_directional_coverage(nodes.directional_coverage[node].data());
  for (std::int64_t z = 0; z < edge; ++z)
    for (std::int64_t y = 0; y < edge; ++y)
      for (std::int64_t x = 0; x < edge; ++x) out[{corner[0] + x, corner[1] + y, corner[2] + z}] = value;
}

}  // namespace

BakeScene::BakeScene() : materials_(1) {
  parameters.frame.voxel_size_m = 256;
  parameters.window_voxels = 16;
}

std::uint32_t BakeScene::add_material(const MaterialView& material) {
  materials_.push_back(material);
  return std::uint32_t(materials_.size() - 1);
}

std::uint32_t BakeScene::add_colour(const Rgba16& linear, AlphaMode mode) {
  MaterialView material;
  std::copy(linear.begin(), linear.end(), material.base_rgba);
  material.alpha_mode = mode;
  return add_material(material);
}

std::uint32_t BakeScene::add_textured(MaterialView material, std::vector<std::uint8_t> rgba, int width, int height) {
  const TextureAlpha alpha = material.alpha_mode == AlphaMode::opaque  ? TextureAlpha::ignore
                             : material.alpha_mode == AlphaMode::blend ? TextureAlpha::blend
                                                                       : TextureAlpha::mask;
  const auto cutoff = std::uint8_t((material.cutoff + 128) / 257);
  textures_.emplace_back(std::move(rgba), width, height, alpha, cutoff, policy_of(1));
  material.texture = std::int32_t(textures_.size() - 1);
  return add_material(material);
}

std::int32_t BakeScene::add_texture(std::vector<std::uint8_t> rgba, int width, int height) {
  textures_.emplace_back(std::move(rgba), width, height, TextureAlpha::blend, 0, policy_of(1));
  return std::int32_t(textures_.size() - 1);
}

Part& BakeScene::add_part(Part part) { return parts_.emplace_back(std::move(part)); }

Part& BakeScene::add_triangle(const Triangle& t, std::uint32_t material) {
  Part& part = fits_floats(t) ? add_mesh({t}, material, t[0]) : add_part(wide_triangle_part(t));
  part.material = material;
  return part;
}

Part& BakeScene::add_mesh(const std::vector<Triangle>& mesh, std::uint32_t material, const LatticeVertex& origin) {
  Part part;
  part.material = material;
  for (const Triangle& t : mesh)
    for (const LatticeVertex& v : t) {
      part.index.push_back(std::uint32_t(part.index.size()));
      const auto p = Vec3<float>(v - origin);
      part.position.insert(part.position.end(), p.begin(), p.end());
    }
  for (int r = 0; r < 3; ++r) part.scene_from_local[4 * r + 3] = double(origin[r]);
  return add_part(std::move(part));
}

Part& BakeScene::add_painted(const Painted& painted) {
  Part& part = add_triangle(painted.triangle, add_colour(painted.colour, painted.mode));
  if (painted.vertex_colours)
    for (const Rgba16& colour : *painted.vertex_colours)
      part.rgba.insert(part.rgba.end(), colour.begin(), colour.end());
  return part;
}

void BakeScene::set_window(const Voxel& min, std::uint32_t edge) {
  parameters.window_min = {min[0], min[1], min[2]};
  parameters.window_voxels = edge;
}

Window BakeScene::window() const { return {Voxel::from(parameters.window_min), parameters.window_voxels}; }

CellVolume BakeScene::bake(int threads) const {
  std::vector<PartView> parts;
  for (const Part& part : parts_) parts.push_back(view_of(part));
  std::vector<TextureView> textures;
  for (const Texture& texture : textures_) textures.push_back(texture.view());
  return bake_cell(
      {{parts.data(), parts.size()}, {materials_.data(), materials_.size()}, {textures.data(), textures.size()}},
      parameters, policy_of(threads));
}

VoxelMap voxels_at(const CellVolume& volume, const CellParameters& parameters, int lod) {
  VoxelMap out;
  const NodeTable& nodes = volume.nodes;
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    const int down = nodes.lod[n] - lod;
    if (down < 0 || (down > 0 && nodes.kind[n] != NodeKind::leaf_constant)) continue;
    const Voxel corner =
        (morton_decode(nodes.key[n]) * brick_edge << down) + (Voxel::from(parameters.window_min) >> lod);
    if (nodes.kind[n] == NodeKind::brick)
      expand_brick(volume.levels[lod], nodes.value[n], corner, out);
    else
      expand_constant(nodes, n, corner, std::int64_t(brick_edge) << down, lod, out);
  }
  return out;
}

std::set<Voxel> positions_of(const VoxelMap& voxels) {
  std::set<Voxel> out;
  for (const auto& [voxel, value] : voxels) out.insert(voxel);
  return out;
}

bool same_bits(const CellVolume& a, const CellVolume& b) {
  const auto same_level = [](const Level& x, const Level& y) {
    return x.key == y.key && x.mask == y.mask && x.first == y.first && x.rgba == y.rgba && x.normal == y.normal &&
           x.directional_coverage == y.directional_coverage && x.voxel_class == y.voxel_class;
  };
  const NodeTable &m = a.nodes, &n = b.nodes;
  return std::equal(a.levels.begin(), a.levels.end(), b.levels.begin(), b.levels.end(), same_level) && m.key == n.key &&
         m.lod == n.lod && m.kind == n.kind && m.child_mask == n.child_mask && m.first_child == n.first_child &&
         m.value == n.value && m.normal == n.normal && m.directional_coverage == n.directional_coverage &&
         m.voxel_class == n.voxel_class && m.has_finest_planes == n.has_finest_planes;
}

const ThreadPool& policy_of(int threads) {
  static std::map<int, ThreadPool> pools;
  return pools.try_emplace(threads, threads).first->second;
}

}  // namespace gigabake::reference
