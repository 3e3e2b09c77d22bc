/// Conversion of glTF to tinygltf's types, compared with tinygltf's own parser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "format/source/gltf/model/model.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using testing::ElementsAre;

constexpr int max_int = std::numeric_limits<int>::max();

/// A document with each member that model_of() reads.
constexpr const char* document = R"({
  "asset": {"version": "2.0"}, "scene": 1, "scenes": [{}, {"nodes": [0, 2]}],
  "extensionsUsed": ["KHR_materials_unlit", "KHR_node_visibility"],
  "nodes": [
    {"mesh": 0, "children": [1], "translation": [1, 2.5, -3], "rotation": [0, 0, 0, 1], "scale": [1, 1, 2]},
    {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1], "extensions": {"KHR_node_visibility": {"visible": false}}},
    {"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0, "ROTATION": 1}}}}],
  "meshes": [
    {"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 3, "mode": 5}]},
    {"primitives": [{"attributes": {}}, {"attributes": {"POSITION": 0},
      "extensions": {"KHR_draco_mesh_compression": {"bufferView": 1, "attributes": {"POSITION": 7}}}}]}],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
    {"bufferView": 0, "byteOffset": 8, "componentType": 5123, "count": 4, "type": "MAT4", "normalized": true},
    {"bufferView": 1, "componentType": 5125, "count": 6, "type": "SCALAR"},
    {"componentType": 5121, "count": 9, "type": "VEC2", "sparse": {"count": 2,
      "indices": {"bufferView": 0, "byteOffset": 4, "componentType": 5123}, "values": {"bufferView": 1}}}],
  "buffers": [{"byteLength": 1, "uri": "data:application/octet-stream;base64,AA=="}],
  "bufferViews": [{"buffer": 0, "byteLength": 64}, {"buffer": 0, "byteOffset": 8, "byteLength": 40, "byteStride": 12}],
  "samplers": [{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}, {}],
  "textures": [{"source": 0, "sampler": 1}, {"extensions": {"EXT_texture_webp": {"source": 0}}}, {}],
  "images": [{"uri": "data:image/png;base64,AA=="}],
  "animations": [{"samplers": [{"input": 0, "output": 1}]}], "skins": [{"joints": [0]}, {"joints": []}],
  "materials": [
    {"name": "plain", "alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
     "normalTexture": {"index": 1, "scale": 0.5}, "occlusionTexture": {"index": 2},
     "emissiveTexture": {"index": 0, "texCoord": 1},
     "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 0.25], "metallicFactor": 0, "metallicRoughnessTexture":
       {"index": 1}, "baseColorTexture": {"index": 0, "texCoord": 2, "extensions": {"KHR_texture_transform":
       {"offset": [0.5, 1], "rotation": 3, "texCoord": 1}}}}},
    {"extensions": {"KHR_materials_unlit": {}, "KHR_materials_pbrSpecularGlossiness":
      {"diffuseFactor": [1, 0, 0, 1], "diffuseTexture": {"index": 0}, "none": null, "empty": {}}}},
    {"extensions": {"KHR_techniques_webgl": {"values": {"u_diffuse": [0.5, 0.5, 1, 1], "on": true, "name": "x"}}}},
    {"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2.5}}}]
})";

bool keep_nothing(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

/// Returns the model that tinygltf's own parser reads.
tinygltf::Model parsed(const std::string& text) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(keep_nothing, nullptr);
  tinygltf::Model out;
  std::string error, warning;
  EXPECT_TRUE(loader.LoadASCIIFromString(&out, &error, &warning, text.data(), unsigned(text.size()), ".")) << error;
  return out;
}

void expect_equal(const tinygltf::Accessor& a, const tinygltf::Accessor& b, std::size_t i) {
  EXPECT_EQ(a, b) << "accessors[" << i << "]";  // without the sparse part, which tinygltf does not compare
  ASSERT_EQ(a.sparse.isSparse, b.sparse.isSparse) << i;
  if (!b.sparse.isSparse) return;
  EXPECT_EQ(a.sparse.count, b.sparse.count);
  EXPECT_EQ(a.sparse.indices.bufferView, b.sparse.indices.bufferView);
  EXPECT_EQ(a.sparse.indices.byteOffset, b.sparse.indices.byteOffset);
  EXPECT_EQ(a.sparse.indices.componentType, b.sparse.indices.componentType);
  EXPECT_EQ(a.sparse.values.bufferView, b.sparse.values.bufferView);
  EXPECT_EQ(a.sparse.values.byteOffset, b.sparse.values.byteOffset);
}

std::vector<std::string> keys_of(const tinygltf::ParameterMap& values) {
  std::vector<std::string> out;
  for (const auto& [key, value] : values) out.push_back(key);
  return out;
}

void expect_equal(const tinygltf::Material& a, const tinygltf::Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.alphaMode, b.alphaMode);
  EXPECT_EQ(a.alphaCutoff, b.alphaCutoff);
  EXPECT_EQ(a.doubleSided, b.doubleSided);
  EXPECT_EQ(a.emissiveFactor, b.emissiveFactor);
  EXPECT_EQ(a.normalTexture, b.normalTexture);
  EXPECT_EQ(a.occlusionTexture, b.occlusionTexture);
  EXPECT_EQ(a.emissiveTexture, b.emissiveTexture);
  EXPECT_EQ(a.pbrMetallicRoughness.baseColorFactor, b.pbrMetallicRoughness.baseColorFactor);
  EXPECT_EQ(a.pbrMetallicRoughness.baseColorTexture, b.pbrMetallicRoughness.baseColorTexture);
  EXPECT_EQ(a.pbrMetallicRoughness.metallicRoughnessTexture, b.pbrMetallicRoughness.metallicRoughnessTexture);
  EXPECT_EQ(a.extensions, b.extensions);
  EXPECT_EQ(keys_of(a.values), keys_of(b.values));
}

TEST(GltfModel, EqualsTheModelThatTinygltfParses) {
  const tinygltf::Model a = model_of(Json::parse(document)), b = parsed(document);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.meshes, b.meshes);
  EXPECT_EQ(a.scenes, b.scenes);
  EXPECT_EQ(a.defaultScene, b.defaultScene);
  EXPECT_EQ(a.textures, b.textures);
  EXPECT_EQ(a.samplers, b.samplers);
  EXPECT_EQ(a.extensionsUsed, b.extensionsUsed);
  EXPECT_EQ(a.images.size(), b.images.size());
  EXPECT_EQ(a.animations.size(), b.animations.size());
  EXPECT_EQ(a.skins.size(), b.skins.size());
  ASSERT_EQ(a.accessors.size(), b.accessors.size());
  for (std::size_t i = 0; i < a.accessors.size(); ++i) expect_equal(a.accessors[i], b.accessors[i], i);
  ASSERT_EQ(a.bufferViews.size(), b.bufferViews.size());
  for (std::size_t i = 0; i < a.bufferViews.size(); ++i) {
    EXPECT_EQ(a.bufferViews[i].buffer, b.bufferViews[i].buffer);
    EXPECT_EQ(a.bufferViews[i].byteOffset, b.bufferViews[i].byteOffset);
    EXPECT_EQ(a.bufferViews[i].byteLength, b.bufferViews[i].byteLength);
    EXPECT_EQ(a.bufferViews[i].byteStride, b.bufferViews[i].byteStride);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) expect_equal(a.materials[i], b.materials[i]);
}

/// tinygltf drops a primitive without attributes. The indices of later primitives in messages would then be too small.
TEST(GltfModel, KeepsAPrimitiveWithoutAttributes) {
  const tinygltf::Model model =
      model_of(Json::parse(R"({"meshes": [{"primitives": [{"material": 1}, {"attributes": {"POSITION": 3}}]}]})"));
  ASSERT_EQ(model.meshes.at(0).primitives.size(), 2u);
  EXPECT_TRUE(model.meshes[0].primitives[0].attributes.empty());
  EXPECT_EQ(model.meshes[0].primitives[1].attributes.at("POSITION"), 3);
}

TEST(GltfModel, AnIndexThatIsNoneNamesNothing) {
  const tinygltf::Model model = model_of(Json::parse(
      R"({"textures": [{"source": 3.0}, {"source": -1}, {"source": 4294967296}, {"source": 0.5}, {"source": null}],
          "materials": [{"normalTexture": {}, "extensions":
            {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": {}}}}]})"));
  std::vector<int> sources;
  for (const tinygltf::Texture& texture : model.textures) sources.push_back(texture.source);
  EXPECT_THAT(sources, ElementsAre(3, max_int, max_int, max_int, max_int));
  const tinygltf::Material& material = model.materials.at(0);
  EXPECT_EQ(material.normalTexture.index, max_int);
  const tinygltf::Value& gloss = material.extensions.at("KHR_materials_pbrSpecularGlossiness");
  EXPECT_EQ(gloss.Get("diffuseTexture").Get("index").GetNumberAsInt(), max_int);
}

/// tinygltf truncates integers in extensions to 32 bits.
TEST(GltfModel, ALargeWholeNumberOfAnExtensionKeepsItsValue) {
  const tinygltf::Model model =
      model_of(Json::parse(R"({"textures": [{"extensions": {"EXT_texture_webp": {"source": 4294967296}}}]})"));
  EXPECT_EQ(model.textures.at(0).extensions.at("EXT_texture_webp").Get("source").GetNumberAsDouble(), 4294967296.0);
}

}  // namespace
}  // namespace gigabake
