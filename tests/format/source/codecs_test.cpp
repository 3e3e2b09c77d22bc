// Compressed glTF models of the shared data equal the same models uncompressed. Unsupported data is refused with a
// clear message.
#include "format/source/image/codecs.h"

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/base/error.h"
#include "format/source/source.h"
#include "format/system/read_file.h"
#include "source_scene.h"
#include "tests/shared_data.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;
using test::Json;
using test::SourceFolder;
using testing::HasSubstr;

using test::shared_data;

TileMesh read_first(const Path& file) {
  const SceneSources s = open_sources(file, {});
  return read_tile(s.tiles.at(0), s.root, ReadScope::everything);
}

/// Returns the corners of all triangles in the scene.
std::vector<Point<Scene>> corners(const TileMesh& mesh) {
  std::vector<Point<Scene>> out;
  for (const Instance& i : mesh.instances) {
    const Primitive& p = mesh.primitives[std::size_t(i.primitive)];
    for (const std::uint32_t v : p.index)
      out.push_back(i.scene_from_local({p.position[3 * v], p.position[3 * v + 1], p.position[3 * v + 2]}));
  }
  return out;
}

/// Returns the max distance from a point of `a` to the nearest point of `b`. Each list has a few thousand points.
double distance_m(const std::vector<Point<Scene>>& a, const std::vector<Point<Scene>>& b) {
  double max_distance = 0;
  for (const auto& p : a) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& q : b)
      nearest = std::min(nearest, (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
    max_distance = std::max(max_distance, nearest);
  }
  return std::sqrt(max_distance);
}

/// Returns the bounds of the texture coordinates.
std::array<float, 4> uv_bounds(const TileMesh& mesh) {
  std::array<float, 4> b{9, 9, -9, -9};
  for (const Primitive& p : mesh.primitives)
    for (std::size_t i = 0; i + 1 < p.uv.size(); i += 2)
      b = {std::min(b[0], p.uv[i]), std::min(b[1], p.uv[i + 1]), std::max(b[2], p.uv[i]), std::max(b[3], p.uv[i + 1])};
  return b;
}

void expect_same_surface(const Path& packed, const Path& plain, double tolerance_m, float uv_tolerance) {
  const TileMesh a = read_first(shared_data() / packed), b = read_first(shared_data() / plain);
  EXPECT_EQ(a.counts.triangles, b.counts.triangles) << packed;
  std::vector<Point<Scene>> p = corners(a), q = corners(b);
  ASSERT_EQ(p.size(), q.size());
  EXPECT_LT(distance_m(p, q), tolerance_m) << packed;
  EXPECT_LT(distance_m(q, p), tolerance_m) << packed;
  const auto u = uv_bounds(a), v = uv_bounds(b);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(u[i], v[i], uv_tolerance) << packed;
}

TEST(Codecs, DracoGivesTheSurfaceOfTheSameModelUnpacked) {
  if (!has_draco()) GTEST_SKIP() << "built without Draco";
  if (!std::filesystem::exists(shared_data())) GTEST_SKIP() << shared_data() << " is absent";
  expect_same_surface("gltf-sample-models/Duck/glTF-Draco/Duck.gltf", "gltf-sample-models/Duck/glTF/Duck.gltf", 2e-3,
                      2e-3f);
}

TEST(Codecs, MeshoptGivesTheSurfaceOfTheSameModelWithinItsQuantization) {
  if (!has_meshopt()) GTEST_SKIP() << "built without meshoptimizer";
  if (!std::filesystem::exists(shared_data())) GTEST_SKIP() << shared_data() << " is absent";
  const Path plain = "gltf-compressed/DucksMeshopt/Duck.glb";
  expect_same_surface("gltf-compressed/DucksMeshopt/Duck-vp-15-vt-15-vn-15.glb", plain, 1.8 / 32768 * 2, 1e-4f);
  expect_same_surface("gltf-compressed/DucksMeshopt/Duck-vp-9-vt-9-vn-9.glb", plain, 1.8 / 512 * 2, 4e-3f);
}

TEST(Codecs, WebPGivesTheColoursInIt) {
  if (!has_webp()) GTEST_SKIP() << "built without WebP";
  const Path folder = shared_data() / "gltf-validator-cases/ext/EXT_texture_webp/data/image";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  for (const char* name : {"VP8L_red.webp", "VP8_red.webp"}) {
    const Image image = decode_image({name, read_whole_file(folder / name)});
    ASSERT_EQ(image.rgba.size(), std::size_t(4 * image.width * image.height)) << name;
    EXPECT_GT(image.rgba[0], 240) << name;
    EXPECT_LT(image.rgba[1], 15) << name;
    EXPECT_FALSE(image.has_alpha) << name;
  }
  EXPECT_TRUE(decode_image({"t", read_whole_file(folder / "VP8L_red_transparent.webp")}).has_alpha);
  std::vector<std::uint8_t> cut = read_whole_file(folder / "VP8L_red.webp");
  cut.resize(cut.size() - 3);
  EXPECT_THROW(decode_image({"cut", cut}), InputError);
}

std::string refusal(const Json& gltf) {
  const SourceFolder folder;
  try {
    read_first(folder.write("a.gltf", gltf));
  } catch (const InputError& e) {
    return e.what();
  }
  return "was read";
}

TEST(Codecs, KtxIsRefusedByNameWithWhatToDo) {
  Json g = test::square_gltf();
  g["extensionsRequired"] = {"KHR_texture_basisu"};
  EXPECT_THAT(refusal(g), HasSubstr("KHR_texture_basisu is not supported"));
  EXPECT_THAT(refusal(g), HasSubstr("convert the images"));
}

/// Returns the square with a meshopt view of 12-byte items. The view has uncompressed bytes, which are invalid for
/// meshopt.
Json packed_square() {
  Json g = test::square_gltf();
  g["buffers"].push_back({{"byteLength", 48}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  g["bufferViews"][0]["buffer"] = 1;
  g["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0}, {"byteLength", 48}, {"byteStride", 12}, {"count", 4}, {"mode", "ATTRIBUTES"}};
  return g;
}

TEST(Codecs, MeshoptViewsAreCheckedBeforeTheyAreUnpacked) {
  if (!has_meshopt()) GTEST_SKIP() << "built without meshoptimizer";
  const auto changed = [](const char* key, const Json& value) {
    Json g = packed_square();
    g["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    return refusal(g);
  };
  EXPECT_THAT(refusal(packed_square()), HasSubstr("not a whole stream of meshopt"));
  EXPECT_THAT(changed("buffer", 1), HasSubstr("has no bytes"));
  EXPECT_THAT(changed("byteLength", 61), HasSubstr("exceed a buffer of 60"));
  EXPECT_THAT(changed("byteStride", 10), HasSubstr("expected a multiple of 4"));
  EXPECT_THAT(changed("count", 4000000000u), HasSubstr("is not the view's byteLength"));
  EXPECT_THAT(changed("mode", "WISHES"), HasSubstr("mode: is unknown"));
  EXPECT_THAT(changed("filter", "QUATERNION"), HasSubstr("does not match the mode"));
  Json g = packed_square();
  g["bufferViews"][0].erase("extensions");
  EXPECT_THAT(refusal(g), HasSubstr("lies in a buffer that has no bytes"));
  g = packed_square();
  constexpr std::uint64_t much = std::uint64_t(1) << 40;
  g["buffers"][1]["byteLength"] = much;
  g["bufferViews"][0]["byteLength"] = much;
  g["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteStride"] = 256;
  g["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = much / 256;
  EXPECT_THAT(refusal(g), HasSubstr("more than 48 packed bytes can hold"));
}

}  // namespace
}  // namespace gigabake
