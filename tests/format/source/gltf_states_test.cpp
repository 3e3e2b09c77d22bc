/// Less common glTF from exporters: URIs, samplers, extensions and old unlit materials.
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/srgb.h"
#include "format/source/content/data_uri.h"
#include "format/source/source.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// A PNG of 1 × 1.
constexpr const char* png_base64 =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGM4kWIEAANWAV/oF4RSAAAAAElFTkSuQmCC";

/// Returns a square with the material `m`. Its texture coordinates are x and y of its positions.
Json textured(const Json& m) {
  Json g = test::square_gltf();
  g["accessors"].push_back({{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}});
  g["accessors"][2]["byteOffset"] = 0;
  g["bufferViews"].push_back(g["bufferViews"][0]);
  g["bufferViews"][2]["byteStride"] = 12;
  g["accessors"][2]["bufferView"] = 2;
  Json& p = g["meshes"][0]["primitives"][0];
  p["attributes"]["TEXCOORD_0"] = 2;
  p["material"] = 0;
  g["materials"] = Json::array({m});
  g["textures"] = Json::array({{{"source", 0}}});
  g["images"] = Json::array({{{"uri", std::string("data:image/png;base64,") + png_base64}}});
  return g;
}

Json base_texture() { return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}; }

struct Opened {
  SourceFolder folder;
  SceneSources sources;
  TileMesh mesh;

  explicit Opened(const Json& gltf, const std::function<void(const SourceFolder&)>& prepare = {}) {
    if (prepare) prepare(folder);
    sources = open_sources(folder.write("a.gltf", gltf), {});
    mesh = read_tile(sources.tiles.at(0), sources.root, ReadScope::everything);
  }
  std::string warnings() const {
    std::string out;
    for (const SourceWarning& w : mesh.warnings) out += (w.is_loss ? "loss: " : "") + w.line() + "\n";
    return out;
  }
};

// 2026-11-25: data URIs with all but six media types were refused as missing, and URIs with parameters as file names.
TEST(DataUri, MayHaveAnyMediaTypeAndParameters) {
  const auto bytes = [](const char* uri) {
    const auto v = data_uri_bytes("a.gltf", "uri", uri);
    return std::string(v.begin(), v.end());
  };
  for (const char* head : {"data:", "DATA:", "data:;", "data:image/jpg;", "data:text/plain;charset=utf-8;",
                           "data:application/x-any;name=\"a.bin\";", "data:image/webp;Charset=x;"})
    EXPECT_EQ(bytes((std::string(head) + "base64,Z2lnYQ==").c_str()), "giga") << head;
  EXPECT_EQ(bytes("data:;BASE64,Z2ln%59Q"), "giga");
  EXPECT_EQ(bytes("data:;base64,Z2l\nnYQ="), "giga");
  EXPECT_EQ(bytes("data:text/plain,a%20b%2Cc"), "a b,c");
  EXPECT_THROW(bytes("data:image/png"), InputError);
  EXPECT_THROW(bytes("data:;base64,Z2*n"), InputError);
}

TEST(GltfStates, TakeImagesOfDataUrisAndPathsWithBackslashes) {
  Json g = textured(base_texture());
  g["images"][0]["uri"] = std::string("data:image/jpg;x=y;base64,") + png_base64;
  EXPECT_EQ(Opened(g).warnings(), "");
  g["images"][0]["uri"] = "Textures\\a%20b.png";
  const auto png = data_uri_bytes("", "", std::string("data:;base64,") + png_base64);
  const Opened there(g, [&](const SourceFolder& folder) {
    std::filesystem::create_directory(folder.path() / "Textures");
    folder.write("Textures/a b.png", std::string(png.begin(), png.end()));
  });
  EXPECT_EQ(there.warnings(), "");
  EXPECT_EQ(there.mesh.images.at(0).bytes, png);
}

// 2026-11-25: a missing image made its whole tile missing, and the message did not name the file.
TEST(GltfStates, AnImageThatCannotBeUsedCostsItselfAndIsListedWithItsFile) {
  Json g = textured(base_texture());
  const auto expect_grey = [&](const std::string& uri, const std::string& reason) {
    g["images"][0] = {{"uri", uri}};
    const Opened made(g);
    EXPECT_THAT(made.warnings(), HasSubstr("loss: unusable images, replaced by grey: 1, e.g. images[0]"));
    EXPECT_THAT(made.warnings(), HasSubstr(reason));
    EXPECT_EQ(made.mesh.primitives.size(), 1u);
    EXPECT_EQ(made.mesh.materials.at(0).base_color[0], grey_without_image);
    EXPECT_EQ(made.mesh.materials.at(0).texture.image, -1);
  };
  expect_grey("Textures\\gone.png", "Textures/gone.png");
  expect_grey("http://localhost/t.png", "expected a path relative to the file");
  expect_grey("../../../etc/passwd", "leaves the source folder");
  expect_grey("data:image/png;base64,AAAA", "neither PNG");
  g["textures"][0] = {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}};
  const Opened basisu(g);
  EXPECT_THAT(basisu.warnings(), HasSubstr("KHR_texture_basisu is not supported"));
  EXPECT_EQ(basisu.mesh.primitives.size(), 1u);
}

TEST(GltfStates, AnImageThatNothingShowsIsNotMissed) {
  Json g = textured(base_texture());
  g["images"].push_back({{"uri", "gone.png"}});
  EXPECT_EQ(Opened(g).warnings(), "");
}

// 2026-11-25: OpenGL's clamp modes made the tile missing.
TEST(GltfStates, WrapModesOfOpenGlAreReadAsClampAndReported) {
  for (const int clamp : {10496, 33069}) {
    Json g = textured(base_texture());
    g["samplers"] = Json::array({{{"wrapS", clamp}, {"wrapT", 33648}}});
    g["textures"][0]["sampler"] = 0;
    const Opened made(g);
    EXPECT_EQ(made.mesh.materials.at(0).texture.wrap_s, Wrap::clamp_to_edge);
    EXPECT_EQ(made.mesh.materials.at(0).texture.wrap_t, Wrap::mirrored_repeat);
    EXPECT_THAT(made.warnings(), HasSubstr("samplers[0].wrapS " + std::to_string(clamp)));
  }
  Json g = textured(base_texture());
  g["samplers"] = Json::array({{{"wrapS", 7}}});
  g["textures"][0]["sampler"] = 0;
  EXPECT_EQ(Opened(g).mesh.materials.at(0).texture.wrap_s, Wrap::repeat);
}

/// A positive rotation is counter-clockwise, as in the Khronos sample viewer, Babylon and Blender for the arrow of
/// +22.5° in TextureTransformTest. A quarter turn maps the image's right, (1, 0), to its top, (0, -1), and its bottom,
/// (0, 1), to its right.
TEST(GltfStates, TextureTransformsTurnCoordinatesCounterClockwiseOnTheImage) {
  Json m = base_texture();
  m["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"rotation", std::acos(-1) / 2}, {"scale", {2, 3}}, {"offset", {0.25, 0.5}}};
  for (const std::size_t first : {0u, 1u}) {  // coordinates are x and y of the positions, then y and z; y is 0
    Json g = textured(m);
    g["accessors"][2]["byteOffset"] = 4 * first;
    const Opened made(g);
    const std::vector<float>&uv = made.mesh.primitives.at(0).uv, &p = made.mesh.primitives.at(0).position;
    for (std::size_t v = 0; v < 4; ++v) {
      EXPECT_NEAR(uv[2 * v], 3 * p[3 * v + first + 1] + 0.25f, 1e-6);
      EXPECT_NEAR(uv[2 * v + 1], -2 * p[3 * v + first] + 0.5f, 1e-6);
    }
  }
}

// 2026-11-25: content that a node hides was baked.
TEST(GltfStates, HiddenNodesAndAllBelowThemAreNotThere) {
  Json g = test::square_gltf();
  g["extensionsUsed"] = g["extensionsRequired"] = {"KHR_node_visibility"};
  const auto hidden = [](bool is_hidden) { return Json{{"KHR_node_visibility", {{"visible", !is_hidden}}}}; };
  g["nodes"] = Json::array({{{"children", {1}}, {"extensions", hidden(true)}},
                            {{"mesh", 0}, {"extensions", hidden(false)}},
                            {{"mesh", 0}, {"extensions", hidden(false)}}});
  g["scenes"][0]["nodes"] = {0, 2};
  EXPECT_EQ(Opened(g).mesh.instances.size(), 1u);
  EXPECT_EQ(Opened(g).warnings(), "");
}

Json technique(const Json& values) {
  return {{"name", "roof"}, {"extensions", {{"KHR_techniques_webgl", {{"technique", 0}, {"values", values}}}}}};
}

// 2026-11-25: materials of KHR_techniques_webgl were white.
TEST(GltfStates, TechniquesGiveTheirDiffuseColourOrAreRefused) {
  const Opened textured_one(textured(technique({{"u_diffuse", {{"index", 0}, {"texCoord", 0}}}})));
  EXPECT_EQ(textured_one.mesh.materials.at(0).texture.image, 0);
  EXPECT_EQ(textured_one.mesh.primitives.at(0).uv.size(), 8u);
  const Opened coloured(textured(technique({{"u_shininess", 3}, {"u_diffuse", {1, 0.5, 0, 0.25}}})));
  EXPECT_THAT(coloured.mesh.materials.at(0).base_color, ElementsAre(1.0f, float(linear_from_srgb(0.5)), 0.0f, 0.25f));
  try {
    Opened(textured(technique({{"u_tint", {1, 0, 0}}})));
    FAIL() << "was read";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("'roof': only the extension KHR_techniques_webgl"));
  }
  Json both = technique({{"u_tint", {1, 0, 0}}});
  both["pbrMetallicRoughness"] = {{"baseColorFactor", {0, 1, 0, 1}}};
  EXPECT_EQ(Opened(textured(both)).mesh.materials.at(0).base_color[1], 1.0f);
}

TEST(GltfStates, MaterialsOfUnknownExtensionsAreReported) {
  const Opened made(textured({{"name", "glass"}, {"extensions", {{"VENDOR_paint", {{"colour", 3}}}}}}));
  EXPECT_THAT(made.warnings(), HasSubstr("describes, taken as white: 1, e.g. 'glass' (VENDOR_paint)"));
}

// 2026-11-25: unlit materials from before 2018, which only emit light, were black.
TEST(GltfStates, BlackMaterialsThatEmitLightHaveItsColour) {
  Json m{{"emissiveFactor", {1, 0.5, 0.25}},
         {"emissiveTexture", {{"index", 0}}},
         {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}}},
         {"alphaMode", "BLEND"}};
  const Opened made(textured(m));
  EXPECT_THAT(made.mesh.materials.at(0).base_color, ElementsAre(1, 0.5f, 0.25f, 1));
  EXPECT_EQ(made.mesh.materials.at(0).texture.image, 0);
  EXPECT_EQ(made.mesh.materials.at(0).alpha_mode, AlphaMode::opaque);
  EXPECT_TRUE(made.mesh.materials.at(0).unlit);
  EXPECT_EQ(made.mesh.primitives.at(0).uv.size(), 8u);
  EXPECT_EQ(made.warnings(), "");
  m.erase("emissiveTexture");
  EXPECT_THAT(Opened(textured(m)).mesh.materials.at(0).base_color, ElementsAre(1, 0.5f, 0.25f, 1));
  m["emissiveFactor"] = {0, 0, 0};
  EXPECT_THAT(Opened(textured(m)).mesh.materials.at(0).base_color, ElementsAre(0, 0, 0, 1));
}

TEST(GltfStates, LightOfOtherMaterialsIsReportedAndNotUsed) {
  Json m = base_texture();
  m["emissiveFactor"] = {1, 1, 1};
  m["emissiveTexture"] = m["occlusionTexture"] = {{"index", 0}};
  Json g = textured(m);
  g["extensionsUsed"] = {"KHR_materials_transmission", "EXT_mesh_features"};
  const Opened made(g);
  EXPECT_EQ(made.mesh.materials.at(0).base_color[0], 1.0f);
  EXPECT_THAT(made.warnings(),
              HasSubstr("textures other than base colours and normal maps, not used: 2, e.g. materials[0].occlusion"));
  EXPECT_THAT(made.warnings(), HasSubstr("extensions that are not read: 1, e.g. 'KHR_materials_transmission'"));
}

}  // namespace
}  // namespace gigabake
