#include "format/diff.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <set>
#include <unordered_map>

#include "format/brick_walk.h"
#include "format/error.h"
#include "format/scene_xml.h"
#include "format/shard_check.h"

namespace gigabake {
namespace {

using Corner = std::array<std::int64_t, 3>;

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    return std::size_t(c[0]) * 0x9e3779b97f4a7c15u ^ std::size_t(c[1]) * 0xc2b2ae3d27d4eb4fu ^
           std::size_t(c[2]) * 0x165667b19e3779f9u;
  }
};

struct Sample {
  std::uint8_t rgba[4];
  std::int8_t normal[2];
};

/// Voxels of one level by their position in that level's voxels of the lattice.
using Voxels = std::unordered_map<Corner, Sample, CornerHash>;

struct Box {
  Corner min;
  std::int64_t edge;
  bool overlaps(const Box& o) const {
    for (std::size_t c = 0; c < 3; ++c)
      if (min[c] >= o.min[c] + o.edge || o.min[c] >= min[c] + edge) return false;
    return true;
  }
  bool holds(const Corner& p) const {
    for (std::size_t c = 0; c < 3; ++c)
      if (p[c] < min[c] || p[c] >= min[c] + edge) return false;
    return true;
  }
};

Box box_of(const SceneCell& cell) { return {cell.lattice_min, std::int64_t(cell.cell_voxels)}; }

/// Adds the shard's voxels of `lod` whose lowest corner lies in `within` (lod-0 voxels).
void add_voxels(const std::filesystem::path& path, int lod, const Box& within, Voxels& out) {
  const ShardHeader header = read_shard_header(path);
  const NodeTable nodes = read_shard_nodes(path);
  const BrickLevel level = read_shard_level(path, lod);
  const auto add = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, const std::uint8_t* rgba,
                       const std::int8_t* normal) {
    const Corner corner{header.lattice_min[0] + (std::int64_t(x) << lod),
                        header.lattice_min[1] + (std::int64_t(y) << lod),
                        header.lattice_min[2] + (std::int64_t(z) << lod)};
    if (!within.holds(corner)) return;
    Sample& s = out[corner];
    std::memcpy(s.rgba, rgba, 4);
    std::memcpy(s.normal, normal, 2);
  };
  for (std::size_t n = 0; n < nodes.key.size(); ++n) {
    const int node_lod = nodes.lod[n];
    if (node_lod == lod && nodes.kind[n] == NodeKind::brick) {
      if (nodes.value[n] >= level.mask.size() / 8)
        throw InputError(path, "/nodes/value", "names a brick that is not there");
      for_each_voxel(level, nodes.value[n], brick_position(nodes.key[n]), add);
    }
    if ((node_lod == lod && nodes.kind[n] == NodeKind::constant) ||
        (node_lod >= lod && nodes.kind[n] == NodeKind::leaf_constant))
      for_each_constant_voxel(nodes, n, node_lod - lod, add);
  }
}

struct Side {
  std::filesystem::path folder;
  SceneDescription scene;
  Voxels voxels_in(const Box& box, int lod) const {
    Voxels out;
    for (const SceneCell& c : scene.cells)
      if (std::uint32_t(lod) < c.lods && box_of(c).overlaps(box)) add_voxels(folder / c.file, lod, box, out);
    return out;
  }
};

void compare(const Sample& a, const Sample& b, DiffPlace& place) {
  ++place.both;
  bool changed = false;
  for (std::size_t c = 0; c < 4; ++c) {
    const int d = std::abs(int(a.rgba[c]) - int(b.rgba[c]));
    place.largest[c] = std::max(place.largest[c], d);
    place.mean[c] += d;
    changed |= d != 0;
  }
  const bool turned = std::memcmp(a.normal, b.normal, 2) != 0;
  place.normals_changed += turned;
  place.changed += changed || turned;
}

DiffPlace compare_box(const Side& a, const Side& b, const std::string& name, const Box& box, int lod) {
  DiffPlace place;
  place.cell = name;
  const Voxels in_a = a.voxels_in(box, lod), in_b = b.voxels_in(box, lod);
  for (const auto& [corner, sample] : in_a) {
    const auto other = in_b.find(corner);
    if (other == in_b.end())
      ++place.only_in_a;
    else
      compare(sample, other->second, place);
  }
  place.only_in_b = in_b.size() - place.both;
  for (double& m : place.mean) m = place.both == 0 ? 0 : m / double(place.both);
  return place;
}

void add_if_different(DiffPlace place, DiffResult& result) {
  ++result.cells_compared;
  if (place.only_in_a + place.only_in_b + place.changed != 0) result.places.push_back(std::move(place));
}

void expect_same_lattice(const std::filesystem::path& path, const SceneDescription& a, const SceneDescription& b) {
  if (a.voxel_size_m != b.voxel_size_m) throw InputError(path, "VoxelSize", "the scenes have voxels of different size");
  if (a.lattice_origin_m != b.lattice_origin_m || a.origin != b.origin)
    throw InputError(path, "LatticeOrigin", "the scenes stand on different lattices");
}

/// Voxels of a cell of B where A has no cell at all.
DiffPlace beyond_a(const Side& a, const Side& b, const SceneCell& cell, int lod) {
  DiffPlace place;
  place.cell = cell.name;
  Voxels voxels;
  add_voxels(b.folder / cell.file, lod, box_of(cell), voxels);
  for (const auto& [corner, sample] : voxels)
    place.only_in_b += std::none_of(a.scene.cells.begin(), a.scene.cells.end(),
                                    [&at = corner](const SceneCell& c) { return box_of(c).holds(at); });
  return place;
}

}  // namespace

DiffResult diff_scenes(const std::filesystem::path& a, const std::filesystem::path& b, int lod) {
  const Side left{a.parent_path(), read_scene(a)}, right{b.parent_path(), read_scene(b)};
  expect_same_lattice(b, left.scene, right.scene);
  DiffResult result;
  std::map<Corner, const SceneCell*> same_place;
  for (const SceneCell& c : right.scene.cells) same_place[c.lattice_min] = &c;
  for (const SceneCell& c : left.scene.cells) {
    if (std::uint32_t(lod) >= c.lods) continue;
    const auto other = same_place.find(c.lattice_min);
    const bool equal = other != same_place.end() && other->second->cell_voxels == c.cell_voxels &&
                       other->second->content_hash[std::size_t(lod)] == c.content_hash[std::size_t(lod)];
    if (equal)
      ++result.cells_compared;
    else
      add_if_different(compare_box(left, right, c.name, box_of(c), lod), result);
  }
  std::set<Corner> places_in_left;
  for (const SceneCell& c : left.scene.cells)
    if (std::uint32_t(lod) < c.lods) places_in_left.insert(c.lattice_min);
  for (const SceneCell& c : right.scene.cells)
    if (std::uint32_t(lod) < c.lods && !places_in_left.contains(c.lattice_min))
      add_if_different(beyond_a(left, right, c, lod), result);
  result.same = result.places.empty();
  return result;
}

}  // namespace gigabake
