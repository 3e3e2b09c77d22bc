#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/source/source.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using test::square_gltf;
using testing::ElementsAre;
using testing::HasSubstr;

TileMesh read(const Json& gltf, const SourceOptions& options = {}) {
  const SourceFolder folder;
  const SceneSources sources = open_sources(folder.write("a.gltf", gltf), options);
  return read_tile(sources.tiles.at(0), sources.root, ReadScope::everything);
}

std::string gltf_refusal(const Json& gltf) {
  try {
    read(gltf);
  } catch (const InputError& e) {
    return e.what();
  }
  return "was read";
}

Json& primitive(Json& gltf) { return gltf["meshes"][0]["primitives"][0]; }

Point<Scene> first_vertex(const TileMesh& mesh, std::size_t instance = 0) {
  const Instance& i = mesh.instances.at(instance);
  const float* p = &mesh.primitives[std::size_t(i.primitive)].position[6];  // (1, 0, 1)
  return i.scene_from_local({p[0], p[1], p[2]});
}

TEST(GltfRead, TurnsYUpToZUp) {
  EXPECT_EQ(first_vertex(read(square_gltf())), (Point<Scene>{1, -1, 0}));
  EXPECT_EQ(first_vertex(read(square_gltf(), {true, {}, UpAxis::z})), (Point<Scene>{1, 0, 1}));
}

TEST(GltfRead, ComposesNodeTransformsInDouble) {
  Json g = square_gltf();
  g["nodes"] = Json::array({{{"translation", {1e7, 0, 0}}, {"children", {1}}},
                            {{"mesh", 0}, {"translation", {0.001, 2, 0}}, {"scale", {-1, 1, 1}}}});
  const TileMesh mesh = read(g);
  EXPECT_EQ(first_vertex(mesh), (Point<Scene>{1e7 + (0.001 - 1), -1, 2}));
  EXPECT_LT(mesh.instances[0].scene_from_local.linear_determinant(), 0);
}

TEST(GltfRead, ReadsTheDefaultSceneAlone) {
  Json g = square_gltf();
  g["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  EXPECT_EQ(read(g).instances.size(), 1u);
  g["scenes"][0]["nodes"] = {0, 1};
  const TileMesh mesh = read(g);
  EXPECT_EQ(mesh.instances.size(), 2u);
  EXPECT_EQ(mesh.primitives.size(), 1u);
  EXPECT_EQ(mesh.counts.triangles, 4u);
}

TEST(GltfRead, ExpandsStripsAndFansAndCountsPointsAndLines) {
  Json g = square_gltf();
  const Json base = primitive(g);
  for (int mode = 0; mode <= 6; ++mode) {
    Json p = base;
    p["mode"] = mode;
    p.erase("indices");
    if (mode != 4) g["meshes"][0]["primitives"].push_back(p);
  }
  const TileMesh mesh = read(g);
  EXPECT_EQ(mesh.counts.skipped_points, 4u);
  EXPECT_EQ(mesh.counts.skipped_lines, 2u + 4u + 3u);
  ASSERT_EQ(mesh.primitives.size(), 3u);
  EXPECT_THAT(mesh.primitives[1].index, ElementsAre(0, 1, 2, 1, 3, 2));  // strip
  EXPECT_THAT(mesh.primitives[2].index, ElementsAre(1, 2, 0, 2, 3, 0));  // fan
}

TEST(GltfRead, PutsSparseValuesInPlaceOfDenseOnes) {
  Json g = square_gltf();
  // Vertex 3 gets the position of vertex 2. The sparse index 3 is the fifth of the buffer's 16-bit indices.
  g["accessors"][0]["sparse"] = {{"count", 1},
                                 {"indices", {{"bufferView", 1}, {"byteOffset", 8}, {"componentType", 5123}}},
                                 {"values", {{"bufferView", 0}, {"byteOffset", 24}}}};
  const std::vector<float> p = read(g).primitives.at(0).position;
  EXPECT_THAT(std::vector<float>(p.begin() + 9, p.end()), ElementsAre(1, 0, 1));
}

TEST(GltfRead, ReadsMaterialsAndTheirExtensions) {
  Json g = square_gltf();
  primitive(g)["material"] = 0;
  g["materials"] = Json::array({{{"alphaMode", "MASK"},
                                 {"alphaCutoff", 0.25},
                                 {"doubleSided", true},
                                 {"extensions",
                                  {{"KHR_materials_unlit", Json::object()},
                                   {"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.5, 0.25, 2, 1}}}}}}}});
  const Material m = read(g).materials.at(0);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided && m.unlit);
  EXPECT_THAT(m.base_color, ElementsAre(0.5f, 0.25f, 1.0f, 1.0f));
}

TEST(GltfRead, PlacesGpuInstancesWithoutCopiesOfTheMesh) {
  Json g = square_gltf();
  g["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  g["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 0}};
  g["nodes"][0]["translation"] = {0, 7, 0};
  const TileMesh mesh = read(g);
  EXPECT_EQ(mesh.primitives.size(), 1u);
  EXPECT_EQ(mesh.counts.triangles, 8u);
  ASSERT_EQ(mesh.instances.size(), 4u);
  EXPECT_EQ(first_vertex(mesh, 1), (Point<Scene>{2, -1, 7}));  // moved by the second position, (1, 0, 0)
  g["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", 0}};
  EXPECT_THAT(gltf_refusal(g), HasSubstr("ROTATION: expected VEC4"));
}

TEST(GltfRead, RefusesPlacementsFromNowhere) {
  Json g = square_gltf();
  g["accessors"].push_back({{"componentType", 5126}, {"count", 1 << 24}, {"type", "VEC3"}});  // no buffer: zeros
  Json node{{"mesh", 0}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", 2}};
  g["nodes"] = Json::array({{{"mesh", 0}}, node});
  g["scenes"][0]["nodes"] = {0, 1};
  EXPECT_THAT(gltf_refusal(g), HasSubstr("more than 2^24 placements"));
}

/// Source  KHR_mesh_quantization: positions are integers. If the accessor is normalized, they are fractions of the
///         integers' range.
TEST(GltfRead, TakesQuantizedPositions) {
  Json g = square_gltf();
  g["extensionsRequired"] = {"KHR_mesh_quantization"};
  // The buffer has no integer positions, so its six 16-bit indices 0 2 1, 0 3 2 serve as two positions. The stride of 4
  // bytes is too small for a position of 6 bytes: the second one begins with the last index of the first.
  g["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}, {"byteStride", 4}});
  g["accessors"][0] = {{"bufferView", 2}, {"componentType", 5122}, {"count", 2}, {"type", "VEC3"}};
  g["accessors"][1]["count"] = 3;
  g["accessors"][1]["bufferView"] = 0;  // zeros: vertex 0 three times
  g["accessors"][1]["componentType"] = 5121;
  EXPECT_THAT(read(g).primitives.at(0).position, ElementsAre(0, 2, 1, 1, 0, 3));
  g["accessors"][0]["normalized"] = true;
  EXPECT_THAT(read(g).primitives.at(0).position,
              ElementsAre(0, 2 / 32767.0f, 1 / 32767.0f, 1 / 32767.0f, 0, 3 / 32767.0f));
}

TEST(GltfRead, NamesWhatIsWrongAndWhere) {
  Json g = square_gltf();
  g["accessors"][0]["bufferView"] = 7;
  EXPECT_THAT(gltf_refusal(g), HasSubstr("accessors[0].bufferView: 7 is beyond the 2 bufferViews"));
  g = square_gltf();
  g["bufferViews"][1]["byteLength"] = 13;
  EXPECT_THAT(gltf_refusal(g), HasSubstr("bufferViews[1]"));
  g = square_gltf();
  g["extensionsRequired"] = {"VENDOR_magic"};
  EXPECT_THAT(gltf_refusal(g), HasSubstr("the extension 'VENDOR_magic' is not supported"));
  g = square_gltf();
  g["accessors"][1]["count"] = 5;
  EXPECT_THAT(gltf_refusal(g), HasSubstr("no whole number of triangles"));
  g = square_gltf();
  g["asset"]["version"] = "1.0";
  EXPECT_THAT(gltf_refusal(g), HasSubstr("is glTF 1.0, expected 2.0; convert it"));
  g = square_gltf();
  g["meshes"] = "many";
  EXPECT_THAT(gltf_refusal(g), HasSubstr("meshes: expected an array"));
  g = square_gltf();
  g["buffers"][0]["uri"] = "data:application/octet-stream;base64,AAAA";
  EXPECT_THAT(gltf_refusal(g), HasSubstr("buffers[0].byteLength"));
}

/// Returns the error message for a square in which the member at `at` has the given value.
std::string refusal_with(const char* at, const char* value) {
  Json g = square_gltf();
  g[Json::json_pointer(at)] = Json::parse(value);
  return gltf_refusal(g);
}

TEST(GltfRead, RefusesStridesAndIndicesThatNoVertexArrayHas) {
  EXPECT_THAT(refusal_with("/bufferViews/0/byteStride", "14"),
              HasSubstr("`byteStride' must be the multiple of 4 : 14"));
  EXPECT_THAT(refusal_with("/bufferViews/0/byteStride", "256"), HasSubstr("Invalid `byteStride' value"));
  EXPECT_THAT(refusal_with("/accessors/1", R"({"componentType": 5123, "count": 6, "type": "SCALAR"})"),
              HasSubstr("accessor[1] invalid bufferView"));
  EXPECT_THAT(refusal_with("/materials", R"([{"emissiveFactor": [1, 1]}])"),
              HasSubstr("materials[0].emissiveFactor: expected 3 numbers"));
}

TEST(GltfRead, RefusesMalformedPartsThatNoBakeUses) {
  EXPECT_THAT(refusal_with("/animations", R"([{"samplers": [{"input": 0}]}])"),
              HasSubstr("animations[0].samplers[0].output: expected a whole number"));
  EXPECT_THAT(refusal_with("/skins", R"([{"joints": [0]}, {}])"), HasSubstr("skins[1].joints: expected a list"));
  EXPECT_THAT(refusal_with("/cameras", R"([{"type": "fisheye"}])"),
              HasSubstr("cameras[0].type: expected orthographic"));
  EXPECT_THAT(refusal_with("/cameras", R"([{"type": "perspective", "perspective": {"yfov": 1}}])"),
              HasSubstr("cameras[0].perspective.znear: expected a number"));
  EXPECT_THAT(refusal_with("/extensions/KHR_lights_punctual/lights", R"([{"type": "spot"}])"),
              HasSubstr("extensions.KHR_lights_punctual.lights[0].spot: expected an object"));
}

TEST(GltfRead, ADataUriThatCannotBeDecodedIsNotRepeatedInTheMessage) {
  Json g = square_gltf();
  const std::string digits(5000, 'A');
  g["buffers"][0]["uri"] = "data:application/octet-stream;base64," + digits + ";" + digits;
  EXPECT_THAT(gltf_refusal(g), HasSubstr("data:application"));
  EXPECT_LT(gltf_refusal(g).size(), 500u);
}

}  // namespace
}  // namespace gigabake
