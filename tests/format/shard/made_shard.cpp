#include "made_shard.h"

#include <bit>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>

#include "core/codec/prediction.h"
#include "core/math/box3.h"
#include "core/octree/parameters.h"
#include "format/shard/levels/brick_walk.h"
#include "format/shard/levels/content_hash.h"

namespace gigabake::made {
namespace {

constexpr std::uint32_t no_child = 0xffffffffu;

bool has_directional_coverage(const ShardShape& shape, int lod) {
  return shape.directional_coverage && (lod > 0 || shape.normals);
}

/// Returns random directional coverage, with a random plane if the shape has normals. Lod-0 voxels have only a plane.
DirectionalCoverage random_directional_coverage(std::mt19937_64& rng, const ShardShape& shape, int lod) {
  DirectionalCoverage directional_coverage{};
  for (std::size_t a = 0; a < coverage_bytes && lod > 0; ++a) directional_coverage[a] = std::uint8_t(1 + rng() % 255);
  if (!shape.normals) return directional_coverage;
  do directional_coverage[directional_coverage_plane] = std::uint8_t(rng() % 64);
  while (!is_plane(directional_coverage[directional_coverage_plane]));
  if (!stores_coverage(directional_coverage[directional_coverage_plane], false))
    std::fill_n(directional_coverage.begin(), coverage_bytes, std::uint8_t(0));
  return directional_coverage;
}

/// The voxels that a brick may have.
using Mask = std::array<std::uint64_t, brick_edge>;
constexpr Mask all_voxels{~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull, ~0ull};

/// Returns the voxels of a child that lie in voxels of its parent.
Mask voxels_below(const std::uint64_t* parent, unsigned octant) {
  Mask below{};
  for (unsigned voxel = 0; voxel < brick_voxels; ++voxel) {
    const unsigned x = 4 * (octant & 1) + (voxel & 7) / 2, y = 4 * (octant >> 1 & 1) + (voxel >> 3 & 7) / 2,
                   z = 4 * (octant >> 2) + (voxel >> 6) / 2;
    if ((parent[z] >> (x + 8 * y) & 1) != 0) below[voxel >> 6] |= std::uint64_t(1) << (voxel & 63);
  }
  return below;
}

/// Range   `allowed` has at least one voxel.
void add_brick(std::mt19937_64& rng, const ShardShape& shape, int lod, const Mask& allowed, BrickLevel& level) {
  std::uint64_t voxels = 0;
  const auto first =
      std::size_t(std::ranges::find_if(allowed, [](std::uint64_t word) { return word != 0; }) - allowed.begin());
  for (std::size_t word = 0; word < allowed.size(); ++word) {
    const std::uint64_t at_least = word == (shape.nested ? first : 3) ? allowed[word] & (0 - allowed[word]) : 0;
    const bool is_thick = shape.nested || at_least != 0;
    const std::uint64_t mask = ((is_thick ? rng() : rng() & rng() & rng()) & allowed[word]) | at_least;
    level.mask.push_back(mask);
    voxels += std::uint64_t(std::popcount(mask));
  }
  level.first.push_back(level.first.back() + voxels);
  const std::uint64_t run = shape.alike ? 1 + rng() % 2000 : 1;
  std::array<std::uint8_t, 4> rgba{};
  std::array<std::int8_t, 2> normal{};
  DirectionalCoverage directional_coverage{};
  for (std::uint64_t v = 0; v < voxels; ++v) {
    if (v % run == 0) {
      for (int c = 0; c < 3; ++c) rgba[std::size_t(c)] = std::uint8_t(rng());
      rgba[3] = std::uint8_t(1 + rng() % 255);
      for (int c = 0; c < 2; ++c) normal[std::size_t(c)] = std::int8_t(int(rng() % 255) - 127);
      directional_coverage = random_directional_coverage(rng, shape, lod);
    }
    level.rgba.insert(level.rgba.end(), rgba.begin(), rgba.end());
    if (shape.normals) level.normal.insert(level.normal.end(), normal.begin(), normal.end());
    if (has_directional_coverage(shape, lod))
      level.directional_coverage.insert(level.directional_coverage.end(), directional_coverage.begin(),
                                        directional_coverage.end());
  }
}

void add_node(NodeTable& n, std::uint64_t key, int lod, NodeKind kind) {
  n.key.push_back(key);
  n.lod.push_back(std::uint8_t(lod));
  n.kind.push_back(kind);
  n.child_mask.push_back(0);
  n.first_child.push_back(no_child);
  n.value.push_back(0);
  n.normal.push_back({0, 0});
  n.directional_coverage.push_back({});
}

/// Returns a random type. On coarse levels a leaf-constant node would cover too many voxels for a test, so they get
/// none.
NodeKind random_kind(std::mt19937_64& rng, int lod, bool is_root) {
  const std::uint64_t dice = is_root ? 0 : rng() % 8;
  return dice == 7 && lod < 3 ? NodeKind::leaf_constant : dice == 6 ? NodeKind::constant : NodeKind::brick;
}

/// Returns the voxels that the brick of a node may have.
Mask allowed_voxels(const Shard& s, std::size_t node) {
  const NodeTable& n = s.nodes;
  for (std::size_t p = 0; p < node; ++p) {
    if (n.lod[p] != n.lod[node] + 1 || n.key[p] != n.key[node] >> 3) continue;
    if (n.kind[p] != NodeKind::brick) return all_voxels;
    return voxels_below(&s.levels[n.lod[p]].mask[brick_edge * n.value[p]], unsigned(n.key[node] & 7));
  }
  return all_voxels;
}

/// Fills the node's content and appends its children to the table.
void grow(std::mt19937_64& rng, const ShardShape& shape, std::size_t i, Shard& s) {
  NodeTable& n = s.nodes;
  const int lod = n.lod[i];
  if (n.kind[i] == NodeKind::brick) {
    n.value[i] = std::uint32_t(s.levels[std::size_t(lod)].mask.size() / 8);
    add_brick(rng, shape, lod, shape.nested ? allowed_voxels(s, i) : all_voxels, s.levels[std::size_t(lod)]);
  } else {
    n.value[i] = std::uint32_t(rng()) | 0x01000000u;
    if (shape.normals) n.normal[i] = {std::int8_t(rng() % 127), std::int8_t(rng() % 127)};
    if (has_directional_coverage(shape, lod)) n.directional_coverage[i] = random_directional_coverage(rng, shape, lod);
  }
  if (lod == 0 || n.kind[i] == NodeKind::leaf_constant) return;
  n.first_child[i] = std::uint32_t(n.key.size());
  unsigned octants = 255;
  for (unsigned octant = 0; shape.nested && n.kind[i] == NodeKind::brick && octant < 8; ++octant)
    if (voxels_below(&s.levels[std::size_t(lod)].mask[brick_edge * n.value[i]], octant) == Mask{})
      octants &= ~(1u << octant);
  while (n.child_mask[i] == 0) n.child_mask[i] = std::uint8_t(rng() & octants);
  while (std::popcount(n.child_mask[i]) > shape.max_children) n.child_mask[i] &= std::uint8_t(n.child_mask[i] - 1);
  for (std::uint64_t c = 0; c < 8; ++c)
    if (n.child_mask[i] >> c & 1) add_node(n, n.key[i] << 3 | c, lod - 1, random_kind(rng, lod - 1, false));
}

ShardHeader header_of(int lods) {
  ShardHeader h;
  h.generator = "gigabake test";
  h.cell = "c_0_0_0";
  h.cell_voxels = 8u << (lods - 1);
  h.voxel_size_m = 0.25;
  h.lods = std::uint32_t(lods);
  h.fingerprint = {1, 2};
  h.triangles = 12;
  return h;
}

void set_bit(BrickLevel& level, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  level.mask[level.mask.size() - 8 + (z & 7)] |= std::uint64_t(1) << ((x & 7) | (y & 7) << 3);
}

/// Voxels keyed by brick key and then by the order within the brick.
using SortedVoxels = std::map<std::pair<std::uint64_t, std::uint32_t>, Voxel>;

void add_level(const SortedVoxels& voxels, BrickLevel& level) {
  level.first.push_back(0);
  for (auto v = voxels.begin(); v != voxels.end(); ++v) {
    if (v == voxels.begin() || std::prev(v)->first.first != v->first.first) {
      level.mask.insert(level.mask.end(), 8, 0);
      level.first.push_back(level.first.back());
    }
    const std::uint32_t bit = v->first.second;
    set_bit(level, bit & 7, bit >> 3 & 7, bit >> 6);
    ++level.first.back();
    level.rgba.insert(level.rgba.end(), v->second.rgba.begin(), v->second.rgba.end());
    level.normal.insert(level.normal.end(), v->second.normal.begin(), v->second.normal.end());
  }
}

/// Returns the nodes for `levels` of sorted voxels, from the root down.
NodeTable nodes_of(const std::vector<SortedVoxels>& levels) {
  NodeTable n;
  for (int lod = int(levels.size()) - 1; lod >= 0; --lod) {
    const std::size_t begin = n.key.size();
    for (const auto& [place, voxel] : levels[std::size_t(lod)])
      if (n.key.size() == begin || n.key.back() != place.first) add_node(n, place.first, lod, NodeKind::brick);
    for (std::size_t i = begin; i < n.key.size(); ++i) {
      n.value[i] = std::uint32_t(i - begin);
      for (std::size_t p = 0; p < begin; ++p) {
        if (n.lod[p] != lod + 1 || n.key[p] != n.key[i] >> 3) continue;
        if (n.child_mask[p] == 0) n.first_child[p] = std::uint32_t(i);
        n.child_mask[p] |= std::uint8_t(1u << (n.key[i] & 7));
      }
    }
  }
  return n;
}

}  // namespace

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "gigabake-format-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Shard random_shard(std::mt19937_64& rng, const ShardShape& shape) {
  Shard s;
  s.header = header_of(shape.lods);
  s.header.has_normals = shape.normals;
  s.header.has_directional_coverage = shape.directional_coverage;
  for (std::int64_t& x : s.header.lattice_min) x = 8 * (std::int64_t(rng() % 2000) - 1000);
  if (rng() % 2 == 0) s.header.origin = Geodetic{48.123456789, -11.5, double(rng() % 1000) / 7};
  s.levels.resize(std::size_t(shape.lods));
  for (BrickLevel& level : s.levels) level.first = {0};
  add_node(s.nodes, 0, shape.lods - 1, random_kind(rng, shape.lods - 1, true));
  for (std::size_t i = 0; i < s.nodes.key.size(); ++i) grow(rng, shape, i, s);
  if (!shape.directional_coverage) s.nodes.directional_coverage.clear();
  s.nodes.has_finest_planes = has_directional_coverage(shape, 0);
  return with_content_hash(std::move(s));
}

Shard with_content_hash(Shard shard) {
  shard.header.content_hash = content_hash(shard);
  return shard;
}

Shard constant_shard() {
  std::mt19937_64 rng(1);
  Shard shard = random_shard(rng, {2, false, 1});
  shard.nodes = {{0}, {1}, {NodeKind::leaf_constant}, {0}, {0xffffffffu}, {0xff010203u}, {{0, 0}}, {{9, 9, 9, 0}}};
  for (BrickLevel& level : shard.levels) level = {{}, {0}, {}, {}, {}};
  return shard;
}

Shard small_shard() {
  Shard s;
  s.header = header_of(2);
  s.header.lattice_min = {-16, 32, 8};
  s.header.lattice_origin_m = {100.5, -3, 0};
  s.header.origin = Geodetic{34.4263, -119.8404, 2.5};
  s.nodes = {{0, 0, 6},
             {1, 0, 0},
             {NodeKind::brick, NodeKind::brick, NodeKind::constant},
             {0x41, 0, 0},
             {1, no_child, no_child},
             {0, 0, 0xff204080u},
             {{0, 0}, {0, 0}, {5, -7}},
             {}};
  s.levels.resize(2);
  s.levels[0] = {{0, 0, 5, 0, 0, 0, 0, std::uint64_t(1) << 63},
                 {0, 3},
                 {1, 2, 3, 255, 4, 5, 6, 128, 7, 8, 9, 1},
                 {0, 0, -127, 0, 64, 63},
                 {}};
  s.levels[1] = {{3, 0, 0, 0, 0, 0, 0, 0}, {0, 2}, {2, 3, 4, 200, 128, 64, 32, 255}, {1, 1, 5, -7}, {}};
  return with_content_hash(std::move(s));
}

Shard small_shard_with_planes(int version) {
  Shard s = small_shard();
  s.header.has_directional_coverage = true;
  s.nodes.directional_coverage = {{}, {}, {0, 0, 0, 0x23}};
  s.levels[1].directional_coverage = {255, 1, 128, 0x1a, 0, 0, 0, 0x3f};
  if (version >= 6) s.levels[0].directional_coverage = {0, 0, 0, 0x1b, 0, 0, 0, 0, 0, 0, 0, 0x3e};
  s.nodes.has_finest_planes = version >= 6;
  return with_content_hash(std::move(s));
}

Shard with_classes(Shard s) {
  s.header.has_classes = true;
  std::uint32_t next = 3;
  const auto add = [&next](std::vector<VoxelClass>& to) { to.push_back(VoxelClass(next = next * 40503 + 1)); };
  for (BrickLevel& level : s.levels)
    for (std::size_t v = 0; v < level.rgba.size() / 4; ++v) add(level.voxel_class);
  for (const NodeKind kind : s.nodes.kind) {
    add(s.nodes.voxel_class);
    if (kind == NodeKind::brick) s.nodes.voxel_class.back() = no_class;
  }
  for (std::size_t v = 0; v < s.above.voxels(); ++v) add(s.above.voxel_class);
  return with_content_hash(std::move(s));
}

DownsampleState small_above() {
  DownsampleState above;
  above.place = {0, 0, 0, 0, 0, 7, 3, 5};
  above.rgba = {1, 2, 3, 255, 4, 5, 6, 1};
  above.normal = {127, 0, -3, 9};
  for (std::uint8_t i = 0; i < 24; ++i) above.raster.push_back(std::uint8_t(10 * i));
  above.patch = {0, 64, 1, 0, 255, 255, 17, 200, 0, 0, 0, 0, 0, 0, 3, 4};
  return above;
}

Shard shard_of(const std::vector<Voxel>& voxels, Vec3i64 lattice_min, std::uint32_t cell_voxels) {
  const int lods = std::bit_width(cell_voxels / 8);
  std::vector<SortedVoxels> levels(std::size_t(lods), SortedVoxels{});
  for (const Voxel& v : voxels) {
    if (!Box3i64::cube(lattice_min, cell_voxels).contains(v.at)) continue;
    const Vec3<std::uint32_t> p(v.at - lattice_min);
    for (int lod = 0; lod < lods; ++lod) {
      const std::uint32_t x = p[0] >> lod, y = p[1] >> lod, z = p[2] >> lod;
      levels[std::size_t(lod)].insert({{morton(x / 8, y / 8, z / 8), (x & 7) | (y & 7) << 3 | (z & 7) << 6}, v});
    }
  }
  Shard s;
  s.header = header_of(lods);
  s.header.lattice_min = lattice_min;
  s.header.cell = "c_" + std::to_string(lattice_min[0]) + "_" + std::to_string(lattice_min[1]) + "_" +
                  std::to_string(lattice_min[2]);
  s.nodes = nodes_of(levels);
  s.nodes.directional_coverage.clear();
  s.levels.resize(std::size_t(lods));
  for (std::size_t lod = 0; lod < levels.size(); ++lod) add_level(levels[lod], s.levels[lod]);
  return with_content_hash(std::move(s));
}

Shard small_overview() {
  std::vector<Voxel> voxels;
  for (std::int64_t i = 0; i < 9; ++i)
    voxels.push_back({{i, i / 2, 15 - i}, {std::uint8_t(20 * i), 30, 7, std::uint8_t(255 - i)}, {std::int8_t(i), -9}});
  Shard overview = shard_of(voxels, {0, 0, 0}, 16);
  overview.header.cell = "p2_-1_1_0";
  overview.header.lattice_min = {-32, 32, 0};
  overview.header.lattice_origin_m = {100.5, -3, 0};
  overview.header.origin = Geodetic{34.4263, -119.8404, 2.5};
  overview.header.first_lod = 1;
  overview.header.copied_lods = 1;
  overview.header.cell_voxels = 32;
  overview.header.has_directional_coverage = true;
  overview.nodes.directional_coverage.assign(overview.nodes.key.size(), {});
  for (BrickLevel& level : overview.levels)
    for (std::size_t v = 0; v < level.rgba.size() / 4; ++v)
      level.directional_coverage.insert(level.directional_coverage.end(), {7, 8, 9, 0x1a});
  return with_content_hash(std::move(overview));
}

SceneCell write_shard_of(const std::filesystem::path& scene_xml, const Shard& shard) {
  std::filesystem::create_directories(scene_xml.parent_path() / "shards");
  const ShardHeader& h = shard.header;
  const std::string file = "shards/" + h.cell + ".h5";
  const StoredShard stored = write_shard(scene_xml.parent_path() / file, shard, {});
  return {h.cell,        file,         h.lattice_min,       h.cell_voxels, h.lods,
          stored.file,   h.triangles,  count_voxels(shard), h.fingerprint, h.content_hash,
          stored.levels, stored.nodes, h.first_lod,         h.copied_lods};
}

SceneDescription write_scene_of(const std::filesystem::path& scene_xml, const std::vector<Shard>& shards) {
  SceneDescription scene;
  scene.generator = "gigabake test";
  std::filesystem::create_directories(scene_xml.parent_path() / "shards");
  for (const Shard& s : shards) {
    const ShardHeader& h = s.header;
    (h.first_lod == 0 ? scene.cells : scene.overviews).push_back(write_shard_of(scene_xml, s));
    scene.voxel_size_m = h.voxel_size_m;
    scene.has_normals = h.has_normals;
    scene.has_directional_coverage = h.has_directional_coverage;
    scene.has_classes = h.has_classes;
    scene.lattice_origin_m = h.lattice_origin_m;
    scene.origin = h.origin;
    scene.has_normals = h.has_normals;
    scene.triangles += h.triangles;
  }
  BakeParameters parameters{.voxel_size_m = scene.voxel_size_m, .lattice_origin_m = scene.lattice_origin_m};
  if (!scene.cells.empty()) parameters.cell_voxels = scene.cells[0].cell_voxels;
  parameters.normals = scene.has_normals;
  parameters.directional_coverage = scene.has_directional_coverage;
  parameters.classes = scene.has_classes;
  scene.parameters = to_json(parameters);
  write_scene(scene_xml, scene);
  return scene;
}

std::string difference(const Shard& a, const Shard& b) {
  const ShardHeader &h = a.header, &g = b.header;
  if (h.generator != g.generator || h.cell != g.cell || h.lattice_min != g.lattice_min ||
      h.cell_voxels != g.cell_voxels || h.first_lod != g.first_lod || h.copied_lods != g.copied_lods ||
      h.voxel_size_m != g.voxel_size_m || h.lattice_origin_m != g.lattice_origin_m || h.origin != g.origin ||
      h.lods != g.lods || h.fingerprint != g.fingerprint || h.content_hash != g.content_hash ||
      h.has_normals != g.has_normals || h.has_directional_coverage != g.has_directional_coverage ||
      h.has_classes != g.has_classes || h.triangles != g.triangles)
    return "headers differ";
  const NodeTable &n = a.nodes, &m = b.nodes;
  if (n.key != m.key || n.lod != m.lod || n.kind != m.kind || n.child_mask != m.child_mask ||
      n.first_child != m.first_child || n.value != m.value || n.normal != m.normal ||
      n.directional_coverage != m.directional_coverage || n.voxel_class != m.voxel_class)
    return "nodes differ";
  if (a.levels.size() != b.levels.size()) return "numbers of levels differ";
  for (std::size_t lod = 0; lod < a.levels.size(); ++lod) {
    const BrickLevel &l = a.levels[lod], &k = b.levels[lod];
    if (l.mask != k.mask || l.first != k.first || l.rgba != k.rgba || l.normal != k.normal ||
        l.directional_coverage != k.directional_coverage || l.voxel_class != k.voxel_class)
      return "levels differ at lod " + std::to_string(lod);
  }
  return "";
}

}  // namespace gigabake::made
