/// Vertex normals of glTF, OBJ and PLY, and normals that a reader cannot use.
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/math/octahedral.h"
#include "format/source/source.h"
#include "made_glb.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using test::MadeGlb;
using testing::ElementsAre;
using testing::IsEmpty;

const VertexNormal none{no_vertex_normal, no_vertex_normal}, up = encode_vertex_normal({0, 0, 1}),
                                                             east = encode_vertex_normal({1, 0, 0}),
                                                             down = encode_vertex_normal({0, 0, -1});
const std::string bad_line = "vertex normals without a direction, replaced by the normals of the triangles: ";

class VertexNormals : public testing::Test {
 protected:
  TileMesh read(const std::string& name, const std::string& content, ReadScope scope = ReadScope::everything) {
    const SceneSources sources = open_sources(folder.write(name, content), {});
    return read_tile(sources.tiles.at(0), sources.root, scope);
  }
  test::SourceFolder folder;
};

std::vector<std::string> warning_lines(const TileMesh& mesh) {
  std::vector<std::string> lines;
  for (const SourceWarning& w : mesh.warnings) lines.push_back(w.line());
  return lines;
}

/// Returns a triangle whose normals are added by add(glb).
template <class Add>
std::string triangle_glb(const Add& add) {
  MadeGlb made;
  const int position = made.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3, test::of_floats);
  const int normal = add(made);
  made.add_primitive(position)["attributes"]["NORMAL"] = normal;
  return made.glb();
}

TEST(VertexNormalCode, KeepsADirectionWithinFourThousandthsOfADegree) {
  test::RandomSeed seed;
  std::mt19937 random{std::uint32_t(seed)};
  std::normal_distribution<double> any;
  for (int i = 0; i < 100000; ++i) {
    const Vec3d n{any(random), any(random), any(random)};
    const VertexNormal code = encode_vertex_normal(n);
    const Vec3d back = decode_vertex_normal(code.data()), across = cross(n, back);
    EXPECT_GT(dot(n, back), 0);
    EXPECT_LT(std::sqrt(dot(across, across) / (dot(n, n) * dot(back, back))), 0.004 / 57.29) << seed;
  }
}

TEST(VertexNormalCode, IsNoneWithoutADirection) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const Vec3d& n : {Vec3d{0, 0, 0}, Vec3d{nan, 0, 1}, Vec3d{0, inf, 0}, Vec3d{-inf, inf, 0}})
    EXPECT_EQ(encode_vertex_normal(n), none);
}

TEST_F(VertexNormals, OfGltfAreFloatsOrNormalizedIntegers) {
  const auto floats = [](MadeGlb& glb) {
    return glb.add(std::vector<float>{0, 0, 1, 2, 0, 0, 0, 0, -0.1f}, 3, test::of_floats);
  };
  const auto shorts = [](MadeGlb& glb) {
    return glb.add(std::vector<std::int16_t>{0, 0, 32767, 32767, 0, 0, 0, 0, -32767}, 3, test::of_signed_shorts, true,
                   8);
  };
  for (const std::string& glb : {triangle_glb(floats), triangle_glb(shorts)}) {
    const TileMesh mesh = read("a.glb", glb);
    EXPECT_THAT(mesh.primitives.at(0).normal, ElementsAre(up, east, down));
    EXPECT_THAT(warning_lines(mesh), IsEmpty());
    EXPECT_THAT(read("a.glb", glb, ReadScope::without_normals).primitives.at(0).normal, IsEmpty());
  }
}

TEST_F(VertexNormals, OfGltfWithoutADirectionAreCountedAlsoByTheScan) {
  const std::string glb = triangle_glb([](MadeGlb& made) {
    return made.add(std::vector<float>{0, 0, 0, 1, 0, 0, std::nanf(""), 0, 1}, 3, test::of_floats);
  });
  EXPECT_THAT(read("a.glb", glb).primitives.at(0).normal, ElementsAre(none, east, none));
  const std::string line = bad_line + "2, e.g. meshes[0].primitives[0].attributes.NORMAL";
  EXPECT_THAT(warning_lines(read("a.glb", glb)), ElementsAre(line));
  EXPECT_THAT(warning_lines(read("a.glb", glb, ReadScope::positions_only)), ElementsAre(line));
}

TEST_F(VertexNormals, OfGltfThatDoNotFitAreIgnored) {
  const std::string glb = triangle_glb([](MadeGlb& made) {
    return made.add(std::vector<float>{0, 0, 1, 1, 0, 0}, 3, test::of_floats);
  });
  const TileMesh mesh = read("a.glb", glb);
  EXPECT_THAT(mesh.primitives.at(0).normal, IsEmpty());
  EXPECT_THAT(warning_lines(mesh), ElementsAre("normals that do not fit the positions, ignored: 1, e.g. "
                                               "meshes[0].primitives[0].attributes.NORMAL"));
}

const std::string obj_square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 1 0 0\nvn 0 0 0\n";

TEST_F(VertexNormals, OfObjHaveTheirOwnIndex) {
  const TileMesh mesh = read("a.obj", obj_square + "f 1//1 2//1 3//2\nf 1//1 3//-3 4\n");
  EXPECT_THAT(mesh.primitives.at(0).index, ElementsAre(0, 1, 2, 0, 3, 4));
  EXPECT_THAT(mesh.primitives.at(0).normal, ElementsAre(up, up, east, up, none));
  EXPECT_THAT(read("a.obj", obj_square + "f 1//1 2//1 3//2\n", ReadScope::without_normals).primitives.at(0).normal,
              IsEmpty());
}

TEST_F(VertexNormals, OfObjThatAreMissingOrHaveNoDirectionAreCounted) {
  for (const ReadScope scope : {ReadScope::everything, ReadScope::positions_only})
    EXPECT_THAT(warning_lines(read("a.obj", obj_square + "f 1//3 2//1 3//9\n", scope)),
                ElementsAre(bad_line + "1, e.g. line 7", "faces that refer to missing normals: 1 of 1, e.g. line 8"));
  EXPECT_THAT(read("a.obj", obj_square + "f 1//3 2//1 3//9\n").primitives.at(0).normal, ElementsAre(none, up, none));
}

TEST_F(VertexNormals, OfPlyAreReadWithTheVertices) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0 1 0 0\n0 1 0 0 0 0\n3 0 1 2\n";
  EXPECT_THAT(read("a.ply", ply).primitives.at(0).normal, ElementsAre(up, east, none));
  EXPECT_THAT(warning_lines(read("a.ply", ply, ReadScope::positions_only)), testing::SizeIs(1));
  EXPECT_THAT(read("a.ply", ply, ReadScope::without_normals).primitives.at(0).normal, IsEmpty());
}

}  // namespace
}  // namespace gigabake
