/// Normal maps of glTF, with their coordinates and tangents.
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/math/octahedral.h"
#include "format/source/source.h"
#include "made_glb.h"

namespace gigabake {
namespace {

using test::Json;
using test::MadeGlb;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::IsEmpty;

/// A PNG of 1 × 1.
constexpr const char* one_texel =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGM4kWIEAANWAV/oF4RSAAAAAElFTkSuQmCC";

const std::vector<float> first_uv{0, 0, 1, 0, 0, 1}, second_uv{0.5f, 0, 0, 0, 0.5f, 1};

/// A triangle with two sets of texture coordinates, a material with base colour and normal map, and two images.
struct MappedTriangle : MadeGlb {
  MappedTriangle() {
    const int position = add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, test::of_floats);
    const int first = add(first_uv, 2, test::of_floats), second = add(second_uv, 2, test::of_floats);
    Json& p = add_primitive(position);
    p["attributes"]["TEXCOORD_0"] = first;
    p["attributes"]["TEXCOORD_1"] = second;
    p["material"] = 0;
    gltf["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}, {"normalTexture", {{"index", 1}}}}};
    gltf["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}};
    gltf["images"] = {{{"uri", one_texel}}, {{"uri", one_texel}}};
    gltf["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  }
  Json& primitive() { return gltf["meshes"][0]["primitives"][0]; }
  Json& map() { return gltf["materials"][0]["normalTexture"]; }
  void add_tangents(const std::vector<float>& xyzw) {
    const int tangent = add(xyzw, 4, test::of_floats);
    primitive()["attributes"]["TANGENT"] = tangent;
  }
};

class GltfNormalMaps : public testing::Test {
 protected:
  TileMesh read(const MadeGlb& made, ReadScope scope = ReadScope::everything) {
    const SceneSources sources = open_sources(folder.write("a.glb", made.glb()), {});
    return read_tile(sources.tiles.at(0), sources.root, scope);
  }
  /// Returns the warnings, which must be the same in each scope.
  std::vector<std::string> warnings_of(const MadeGlb& made) {
    std::vector<std::string> lines;
    for (const SourceWarning& w : read(made).warnings) lines.push_back((w.is_loss ? "loss: " : "") + w.line());
    for (const ReadScope scope : {ReadScope::without_normals, ReadScope::positions_only})
      EXPECT_EQ(read(made, scope).warnings, read(made).warnings);
    return lines;
  }
  test::SourceFolder folder;
};

TEST_F(GltfNormalMaps, HaveSamplerScaleAndImage) {
  MappedTriangle made;
  made.map()["scale"] = 0.25;
  const TileMesh mesh = read(made);
  const NormalMap& map = mesh.materials.at(0).normal_map;
  EXPECT_EQ(map.texture.image, 1);
  EXPECT_EQ(map.texture.wrap_s, Wrap::clamp_to_edge);
  EXPECT_EQ(map.texture.wrap_t, Wrap::mirrored_repeat);
  EXPECT_TRUE(map.texture.nearest);
  EXPECT_EQ(map.scale, 0.25f);
  EXPECT_FALSE(mesh.images.at(1).bytes.empty());
  EXPECT_EQ(mesh.materials.at(0).texture.image, 0);
  EXPECT_THAT(warnings_of(made), IsEmpty());
}

TEST_F(GltfNormalMaps, ShareTheCoordinatesOfTheColourOrHaveTheirOwn) {
  MappedTriangle made;
  Primitive p = read(made).primitives.at(0);
  EXPECT_TRUE(p.shares_uv);
  EXPECT_THAT(p.uv, ElementsAreArray(first_uv));
  EXPECT_THAT(p.normal_uv, IsEmpty());
  made.map()["texCoord"] = 1;
  p = read(made).primitives.at(0);
  EXPECT_FALSE(p.shares_uv);
  EXPECT_THAT(p.uv, ElementsAreArray(first_uv));
  EXPECT_THAT(p.normal_uv, ElementsAreArray(second_uv));
  made.gltf["materials"][0].erase("pbrMetallicRoughness");
  p = read(made).primitives.at(0);
  EXPECT_THAT(p.uv, IsEmpty());
  EXPECT_THAT(p.normal_uv, ElementsAreArray(second_uv));
}

TEST_F(GltfNormalMaps, HaveTheirOwnTransform) {
  MappedTriangle made;
  made.map()["extensions"]["KHR_texture_transform"] = {{"offset", {0.5, 2}}, {"scale", {2, -1}}, {"texCoord", 1}};
  const Primitive p = read(made).primitives.at(0);
  EXPECT_THAT(p.uv, ElementsAreArray(first_uv));
  EXPECT_THAT(p.normal_uv, ElementsAre(1.5f, 2, 0.5f, 2, 1.5f, 1));
}

TEST_F(GltfNormalMaps, AreNotReadWithoutNormals) {
  MappedTriangle made;
  made.map()["texCoord"] = 1;
  made.add_tangents({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1});
  for (const ReadScope scope : {ReadScope::without_normals, ReadScope::positions_only}) {
    const TileMesh mesh = read(made, scope);
    EXPECT_THAT(mesh.primitives.at(0).normal_uv, IsEmpty());
    EXPECT_THAT(mesh.primitives.at(0).tangent, IsEmpty());
    EXPECT_FALSE(mesh.primitives.at(0).shares_uv);
    if (scope == ReadScope::without_normals) {
      EXPECT_THAT(mesh.images.at(1).bytes, IsEmpty());
    }
  }
}

TEST_F(GltfNormalMaps, HaveTangentsWithASide) {
  MappedTriangle made;
  made.add_tangents({1, 0, 0, 1, 0, 2, 0, -1, 0, 0, -0.1f, 1});
  EXPECT_THAT(read(made).primitives.at(0).tangent,
              ElementsAre(encode_vertex_tangent({1, 0, 0}, false), encode_vertex_tangent({0, 1, 0}, true),
                          encode_vertex_tangent({0, 0, -1}, false)));
  EXPECT_THAT(warnings_of(made), IsEmpty());
  made.gltf["materials"][0].erase("normalTexture");
  EXPECT_THAT(read(made).primitives.at(0).tangent, IsEmpty()) << "tangents without a normal map have no use";
}

TEST_F(GltfNormalMaps, CountTangentsWithoutADirection) {
  MappedTriangle made;
  made.add_tangents({0, 0, 0, 1, std::nanf(""), 0, 0, 1, 1, 0, 0, 0});
  const TileMesh mesh = read(made);
  for (const VertexTangent& t : mesh.primitives.at(0).tangent) EXPECT_EQ(t[0], no_vertex_normal);
  EXPECT_THAT(warnings_of(made),
              ElementsAre("vertex tangents without a direction, computed from the texture coordinates: 3, e.g. "
                          "meshes[0].primitives[0].attributes.TANGENT"));
}

TEST_F(GltfNormalMaps, IgnoreTangentsThatDoNotFit) {
  MappedTriangle made;
  made.add_tangents({1, 0, 0, 1, 1, 0, 0, 1});
  EXPECT_THAT(read(made).primitives.at(0).tangent, IsEmpty());
  EXPECT_THAT(warnings_of(made), ElementsAre("tangents that do not fit the positions, ignored: 1, e.g. "
                                             "meshes[0].primitives[0].attributes.TANGENT"));
}

TEST_F(GltfNormalMaps, WithoutCoordinatesAreReportedAndNotUsed) {
  MappedTriangle made;
  made.map()["texCoord"] = 5;
  const Primitive p = read(made).primitives.at(0);
  EXPECT_FALSE(p.shares_uv);
  EXPECT_THAT(p.normal_uv, IsEmpty());
  EXPECT_THAT(warnings_of(made),
              ElementsAre("normal maps without the texture coordinates that they require, not used: 1, e.g. "
                          "meshes[0].primitives[0].attributes.TEXCOORD_5"));
}

TEST_F(GltfNormalMaps, WithUnusableImagesAreReportedAndNotUsed) {
  MappedTriangle made;
  made.gltf["images"][1]["uri"] = "missing.png";
  EXPECT_EQ(read(made).materials.at(0).normal_map.texture.image, -1);
  EXPECT_EQ(read(made).materials.at(0).texture.image, 0) << "the colour stays";
  EXPECT_THAT(warnings_of(made), ElementsAre(HasSubstr("loss: unusable images of normal maps, not used: 1, e.g. ")));
  made.map()["index"] = 7;
  EXPECT_THAT(warnings_of(made), ElementsAre(HasSubstr("a material names no texture of the file")));
}

TEST_F(GltfNormalMaps, HaveAFiniteScale) {
  MappedTriangle made;
  made.map()["scale"] = 1e300;
  EXPECT_EQ(read(made).materials.at(0).normal_map.scale, 1);
  EXPECT_THAT(warnings_of(made), ElementsAre("scales of normal maps that are not finite, taken as 1: 1, e.g. "
                                             "materials[0].normalTexture.scale"));
}

TEST_F(GltfNormalMaps, OfUnlitMaterialsAreNotUsed) {
  MappedTriangle made;
  made.gltf["materials"][0]["extensions"]["KHR_materials_unlit"] = Json::object();
  EXPECT_EQ(read(made).materials.at(0).normal_map.texture.image, -1);
  EXPECT_THAT(warnings_of(made), IsEmpty());
}

}  // namespace
}  // namespace gigabake
