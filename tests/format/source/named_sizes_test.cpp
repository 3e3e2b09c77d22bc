// Levels of materials and nodes: which level each placement gets, and what a tile's identity depends on.
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/base/error.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/levels/source_levels.h"
#include "format/source/tile_hash.h"
#include "made_glb.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using test::Json;
using test::MadeGlb;

/// Opens a scene with one source, and sets its levels.
SceneSources opened(const test::SourceFolder& folder, const std::string& file, const Json& materials, const Json& nodes,
                    BakeParameters& parameters) {
  Json source{{"path", file}};
  if (!materials.empty()) source["voxel_size_of_material"] = materials;
  if (!nodes.empty()) source["voxel_size_of_node"] = nodes;
  SceneSources sources =
      open_sources(folder.write("scene.json", Json{{"gigabake", 1}, {"sources", {source}}}), SourceOptions());
  set_source_levels(sources, parameters);
  return sources;
}

std::int32_t stated(const Json& lods, const std::string& name) {
  return lods.contains(name) ? lods[name].get<std::int32_t>() : not_stated;
}

Json sizes_of(const Json& lods, double voxel_m) {
  Json sizes = Json::object();
  for (const auto& [name, lod] : lods.items()) sizes[name] = std::ldexp(voxel_m, lod.get<int>());
  return sizes;
}

/// A tree of nodes, each with one mesh of triangles with random materials. The x of a node's translation is its number.
class RandomTree {
 public:
  explicit RandomTree(std::mt19937_64& random) {
    const std::vector<float> corners{0, 0, 0, 0, 1, 0, 0, 0, 1};
    const int position = glb_.add(corners, 3, test::of_floats);
    Json nodes = Json::array(), meshes = Json::array();
    for (int m = 0; m < 3; ++m) glb_.gltf["materials"].push_back(m == 2 ? Json::object() : Json{{"name", letter(m)}});
    for (int n = 0; n < 12; ++n) {
      Json mesh{{"primitives", Json::array()}};
      for (std::uint64_t count = random() % 3; count > 0; --count) {
        Json primitive{{"attributes", {{"POSITION", position}}}};
        if (const std::uint64_t material = random() % 4; material < 3) primitive["material"] = material;
        mesh["primitives"].push_back(primitive);
      }
      meshes.push_back(mesh);
      Json node{{"mesh", n}, {"translation", {1, 0, 0}}};
      if (random() % 4 != 0) node["name"] = letter(int(random() % 4));
      parent_.push_back(n == 0 ? -1 : int(random() % std::uint64_t(n)));
      nodes.push_back(node);
      if (n > 0) nodes[std::size_t(parent_.back())]["children"].push_back(n);
    }
    for (std::size_t n = 1; n < nodes.size(); ++n) nodes[n]["translation"][0] = double(n) - double(parent_[n]);
    nodes[0]["translation"][0] = 0;
    glb_.gltf["nodes"] = nodes, glb_.gltf["meshes"] = meshes;
  }

  const MadeGlb& glb() const { return glb_; }

  /// Returns the levels of the placements per node and material (−1: none), by the rule in the documents.
  std::multimap<int, std::pair<std::string, std::int32_t>> expected(const Json& materials, const Json& nodes) const {
    std::multimap<int, std::pair<std::string, std::int32_t>> out;
    for (std::size_t n = 0; n < parent_.size(); ++n)
      for (const Json& primitive : glb_.gltf["meshes"][n]["primitives"]) {
        std::string material = "none";
        std::int32_t lod = not_stated;
        if (primitive.contains("material")) {
          material = glb_.gltf["materials"][primitive["material"].get<std::size_t>()].value("name", "");
          lod = stated(materials, material);
        }
        for (int at = int(n); lod == not_stated && at >= 0; at = parent_[std::size_t(at)])
          lod = stated(nodes, glb_.gltf["nodes"][std::size_t(at)].value("name", ""));
        out.emplace(int(n), std::pair(material, lod));
      }
    return out;
  }

  static std::string letter(int i) { return {char('a' + i)}; }

 private:
  MadeGlb glb_;
  std::vector<int> parent_;
};

TEST(NamedSizes, GivePlacementsTheLevelOfMaterialThenOfTheDeepestNode) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  for (int round = 0; round < 200; ++round) {
    const RandomTree tree(random);
    const test::SourceFolder folder;
    folder.write("tree.glb", tree.glb().glb());
    Json materials = Json::object(), nodes = Json::object();
    for (const char* name : {"a", "b", ""})
      if (random() % 3 == 0) materials[name] = random() % 4;
    for (const char* name : {"a", "b", "c", "d", ""})
      if (random() % 3 == 0) nodes[name] = random() % 4;
    materials["finest"] = 0;
    BakeParameters parameters;
    parameters.voxel_size_m = 2;
    const SceneSources sources =
        opened(folder, "tree.glb", sizes_of(materials, 0.25), sizes_of(nodes, 0.25), parameters);
    EXPECT_EQ(parameters.voxel_size_m, 0.25);
    const TileRef& tile = sources.tiles.at(0);
    EXPECT_EQ(tile.lod, 3);
    const auto expected = tree.expected(materials, nodes);
    for (const ReadScope scope : {ReadScope::positions_only, ReadScope::everything}) {
      const TileMesh mesh = read_tile(tile, sources.root, scope);
      ASSERT_EQ(mesh.instances.size(), expected.size()) << "round " << round;
      std::multimap<int, std::int32_t> of_nodes;
      for (const auto& [node, placement] : expected) of_nodes.emplace(node, placement.second);
      std::map<int, std::vector<std::int32_t>> lods;
      for (const Instance& instance : mesh.instances) {
        lods[int(instance.scene_from_local.m[0][3])].push_back(instance.lod);
        EXPECT_EQ(lod_of(instance, tile), instance.lod == not_stated ? 3 : instance.lod);
      }
      for (const auto& [node, found] : lods) {
        const auto [begin, end] = of_nodes.equal_range(node);
        std::vector<std::int32_t> of_node;
        for (auto at = begin; at != end; ++at) of_node.push_back(at->second);
        EXPECT_EQ(found, of_node) << "round " << round << ", node " << node;
      }
    }
  }
}

TEST(NamedSizes, AreListedByTheNamesThatAFileHas) {
  std::mt19937_64 random(1);
  const RandomTree tree(random);
  const test::SourceFolder folder;
  folder.write("tree.glb", tree.glb().glb());
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  const SceneSources sources =
      opened(folder, "tree.glb", {{"a", 1}, {"b", 2}, {"x", 4}}, {{"a", 1}, {"y", 2}}, parameters);
  const TileMesh mesh = read_tile(sources.tiles.at(0), sources.root, ReadScope::positions_only);
  EXPECT_EQ(mesh.sized, (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_THROW(sources.tiles[0].named_sizes->refuse_unknown(4), UsageError);
  EXPECT_EQ(parameters.coarsest_lod, 2u);
}

TEST(NamedSizes, ChangeTheIdentityOfTilesThatHaveTheNames) {
  std::mt19937_64 random(1);
  const RandomTree tree(random);
  const test::SourceFolder folder;
  folder.write("tree.glb", tree.glb().glb());
  const auto hash_of = [&](const Json& materials, const Json& nodes) {
    BakeParameters parameters;
    parameters.voxel_size_m = 1;
    const SceneSources sources = opened(folder, "tree.glb", materials, nodes, parameters);
    return tile_hash(sources.tiles.at(0), sources.root);
  };
  const Hash128 plain = hash_of({}, {});
  EXPECT_EQ(hash_of({{"x", 4}}, {{"y", 2}}), plain) << "names that the file does not have";
  EXPECT_NE(hash_of({{"a", 4}}, {}), plain);
  EXPECT_NE(hash_of({{"a", 4}}, {}), hash_of({{"a", 2}}, {}));
  EXPECT_NE(hash_of({}, {{"a", 4}}), hash_of({{"a", 4}}, {}));
  EXPECT_EQ(hash_of({{"a", 4}, {"x", 2}}, {}), hash_of({{"a", 4}}, {}));
}

TEST(NamedSizes, OfAnObjComeFromMaterialThenGroupThenObject) {
  const test::SourceFolder folder;
  const std::string face = "f 1 2 3\n";
  folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + face + "o House 1\n" + face + "g roof\n" + face +
                            "usemtl glass\n" + face + "g left wall\n" + face + "usemtl other\n" + face + "o garden\n" +
                            face + "g\n" + face);
  BakeParameters parameters;
  parameters.voxel_size_m = 1;
  const SceneSources sources =
      opened(folder, "a.obj", {{"glass", 16}}, {{"House 1", 2}, {"roof", 4}, {"wall", 8}, {"garden", 1}}, parameters);
  const TileRef& tile = sources.tiles.at(0);
  for (const ReadScope scope : {ReadScope::positions_only, ReadScope::everything}) {
    const TileMesh mesh = read_tile(tile, sources.root, scope);
    std::map<std::int32_t, std::size_t> triangles;
    for (const Instance& i : mesh.instances)
      triangles[i.lod] += mesh.primitives.at(std::size_t(i.primitive)).index.size() / 3;
    // Lines after each face: not stated, House 1, roof, glass, glass, wall, wall, garden.
    EXPECT_EQ(triangles,
              (std::map<std::int32_t, std::size_t>{{not_stated, 1}, {1, 1}, {2, 1}, {4, 2}, {3, 2}, {0, 1}}));
    EXPECT_EQ(mesh.sized, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
  }
}

TEST(NamedSizes, ComeBackFromTheirText) {
  NamedVoxelSizes sizes;
  sizes.of_materials = {{"", {}, 3}, {"a \"b\"", {}, 10}};
  sizes.of_nodes = {{"ä", {}, 0}};
  const NamedVoxelSizes back = named_voxel_sizes_from_json(to_json(sizes));
  EXPECT_EQ(to_json(back), to_json(sizes));
  EXPECT_EQ(lod_of_material(&back, "a \"b\""), 10);
  EXPECT_EQ(lod_of_node(&back, "ä"), 0);
  EXPECT_EQ(lod_of_node(&back, ""), not_stated);
  for (const char* wrong : {"", "[]", R"({"materials": {"a": 11}})", R"({"nodes": {"a": -1}})",
                            R"({"nodes": {"a": 1.5}})", R"({"nodes": [1]})", R"({"other": {}})"})
    EXPECT_THROW(named_voxel_sizes_from_json(wrong), UsageError) << wrong;
}

}  // namespace
}  // namespace gigabake
