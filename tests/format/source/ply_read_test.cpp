// PLY meshes, written here by hand.
#include <algorithm>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "mesh_file.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

/// The values of a binary PLY.
class Body {
 public:
  explicit Body(bool is_big) : is_big_(is_big) {}
  template <class T>
  Body& put(std::initializer_list<T> values) {
    for (const T v : values) {
      char bytes[sizeof(T)];
      std::memcpy(bytes, &v, sizeof v);
      if (is_big_) std::reverse(bytes, bytes + sizeof v);
      text.append(bytes, sizeof v);
    }
    return *this;
  }
  std::string text;

 private:
  bool is_big_;
};

class PlyMesh : public test::MeshFile {
 protected:
  PlyMesh() : MeshFile("a.ply") {}
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string faces = "property list uchar int vertex_indices\n";
  const std::string square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  std::string ascii(const std::string& vertices, const std::string& of_faces, const std::string& body) const {
    return "ply\nformat ascii 1.0\nelement vertex " + vertices + "\n" + xyz + "element face " + of_faces + "\n" +
           faces + "end_header\n" + body;
  }
};

const std::string ply_png_head = "\x89PNG\r\n\x1a\n, not looked at";

std::vector<std::string> ply_lines_of(const TileMesh& mesh) {
  std::vector<std::string> lines;
  for (const SourceWarning& w : mesh.warnings) lines.push_back((w.is_loss ? "loss: " : "") + w.line());
  return lines;
}

TEST_F(PlyMesh, ReadsPolygonsAsAnObjDoes) {
  const TileMesh mesh = read(ascii("4", "2", square + "4 0 1 2 3\n3 0 2 1\n"));
  EXPECT_EQ(mesh.counts.triangles, 3u);
  ASSERT_EQ(mesh.primitives.size(), 1u);
  EXPECT_THAT(mesh.primitives[0].index, ElementsAre(0, 1, 2, 0, 2, 3, 0, 2, 1));
  EXPECT_THAT(mesh.primitives[0].position, ElementsAre(0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0));
  EXPECT_THAT(mesh.primitives[0].rgba, IsEmpty());
  EXPECT_EQ(mesh.instances[0].scene_from_local({0, 1, 0}), (Point<Scene>{0, 0, 1})) << "y is up";
  EXPECT_EQ(
      read(ascii("4", "1", square + "4 0 1 2 3\n"), {true, {}, UpAxis::z}).instances[0].scene_from_local({0, 1, 0}),
      (Point<Scene>{0, 1, 0}));
}

// 2026-11-25: the whole file and the whole mesh were kept in memory.
TEST_F(PlyMesh, ComesInPartsThatAreSmallWhereMemoryIsSmall) {
  std::string vertices, of_faces;
  for (int v = 0; v < 1000; ++v) vertices += std::to_string(v % 37) + " " + std::to_string(v) + " 0\n";
  for (int f = 0; f < 40000; ++f)
    of_faces += "3 " + std::to_string(f % 998) + " " + std::to_string((7 * f + 1) % 1000) + " " +
                std::to_string(f % 998 + 2) + "\n";
  for (const std::uint64_t limit : {std::uint64_t(0), std::uint64_t(1) << 24}) {
    const auto corners = [](const Primitive& p, std::vector<float>& to) {
      for (const std::uint32_t v : p.index) to.insert(to.end(), &p.position[3 * v], &p.position[3 * v] + 3);
    };
    std::vector<float> whole, in_parts;
    corners(read(ascii("1000", "40000", vertices + of_faces)).primitives.at(0), whole);
    set_memory_limit(limit);
    std::size_t parts = 0;
    const TileMesh mesh = read_parts([&](std::size_t index, Primitive&& part) {
      EXPECT_EQ(index, parts++);
      corners(part, in_parts);
    });
    set_memory_limit(0);
    EXPECT_EQ(parts, limit == 0 ? 1u : 3u);
    EXPECT_EQ(mesh.counts.triangles, 40000u);
    EXPECT_EQ(mesh.instances.size(), parts);
    EXPECT_EQ(mesh.materials.size(), 1u) << "one for all parts";
    EXPECT_TRUE(in_parts == whole) << limit;
  }
}

TEST_F(PlyMesh, ReadsBothByteOrdersEveryTypeAndWhatItDoesNotKnow) {
  for (const bool is_big : {false, true}) {
    Body body(is_big);
    body.put<std::uint16_t>({7}).put<std::int8_t>({2}).put<double>({1.5, 2.5});  // an element that gigabake ignores
    for (const float x : {0.f, 1.f, 2.f}) {
      body.put<float>({0.5f}).put<double>({x}).put<std::int16_t>({-3}).put<std::uint32_t>({x == 1 ? 4u : 0u});
      body.put<std::uint8_t>({255, 128, 0, 51});
    }
    body.put<std::uint32_t>({3}).put<std::uint16_t>({0, 1, 2}).put<std::int32_t>({-1});
    const std::string header =
        std::string("ply\r\nformat ") + (is_big ? "binary_big_endian" : "binary_little_endian") +
        " 1.0\r\ncomment made by hand\r\nobj_info none\r\nelement camera 1\r\nproperty ushort id\r\n"
        "property list char double focal\r\nelement vertex 3\r\nproperty float32 quality\r\nproperty float64 x\r\n"
        "property int16 y\r\nproperty uint32 z\r\nproperty uint8 red\r\nproperty uchar green\r\nproperty uchar blue\r\n"
        "property uchar alpha\r\nelement face 1\r\nproperty list uint ushort vertex_index\r\nproperty int flags\r\n"
        "end_header\r\n";
    const TileMesh mesh = read(header + body.text);
    ASSERT_EQ(mesh.primitives.size(), 1u);
    EXPECT_THAT(mesh.primitives[0].position, ElementsAre(0, -3, 0, 1, -3, 4, 2, -3, 0));
    EXPECT_THAT(mesh.primitives[0].index, ElementsAre(0, 1, 2));
    // sRGB 128 is 0.2158605 of linear light (IEC 61966-2-1).
    EXPECT_THAT(std::vector(mesh.primitives[0].rgba.begin(), mesh.primitives[0].rgba.begin() + 4),
                ElementsAre(65535, 14146, 0, 13107));
    EXPECT_EQ(mesh.materials[0].alpha_mode, AlphaMode::blend);
  }
}

TEST_F(PlyMesh, ReadsTriangleStripsAndFacesBeforeTheirVertices) {
  const TileMesh mesh = read("ply\nformat ascii 1.0\nelement face 1\n" + faces + "element vertex 4\n" + xyz +
                             "element tristrips 1\nproperty list int int vertex_indices\nend_header\n3 0 1 2\n" +
                             square + "8 0 1 2 3 -1 0 1 2\n");
  EXPECT_THAT(mesh.primitives.at(0).index, ElementsAre(0, 1, 2, 0, 1, 2, 1, 3, 2, 0, 1, 2));
}

TEST_F(PlyMesh, ReadsTextureCoordinatesOfCornersAndOfVertices) {
  folder.write("one.png", ply_png_head);
  const std::string corners = "ply\nformat ascii 1.0\ncomment TextureFile one.png\nelement vertex 4\n" + xyz +
                              "element face 1\n" + faces +
                              "property list uchar float texcoord\nproperty int texnumber\nend_header\n" + square;
  const TileMesh mesh = read(corners + "3 0 1 2 6 0 0 1 0 0.5 0.25 0\n");
  EXPECT_THAT(mesh.primitives.at(0).uv, ElementsAre(0, 1, 1, 1, 0.5f, 0.75f));
  EXPECT_EQ(mesh.materials.at(0).texture.image, 0);
  EXPECT_EQ(mesh.images.size(), 1u);
  const Hash128 hash = tile_hash(sources.tiles[0], sources.root);
  folder.write("one.png", ply_png_head + "another");
  EXPECT_NE(tile_hash(sources.tiles[0], sources.root), hash);
  const TileMesh of_vertices = read("ply\nformat ascii 1.0\ncomment TextureFile one.png\nelement vertex 3\n" + xyz +
                                    "property float s\nproperty float t\nelement face 1\n" + faces +
                                    "end_header\n0 0 0 0.5 1\n1 0 0 0 0\n0 1 0 1 0\n3 0 1 2\n");
  EXPECT_THAT(of_vertices.primitives.at(0).uv, ElementsAre(0.5f, 0, 0, 1, 1, 1));
  EXPECT_EQ(of_vertices.materials.at(0).texture.image, 0);
}

TEST_F(PlyMesh, IsGreyWithAWarningWhereItsImageIsMissing) {
  const std::string text = "ply\nformat ascii 1.0\ncomment TextureFile /home/me/missing.png\nelement vertex 4\n" + xyz +
                           "element face 1\n" + faces + "property list uchar float texcoord\nend_header\n" + square +
                           "3 0 1 2 6 0 0 1 0 0.5 0.25\n";
  const TileMesh mesh = read(text);
  EXPECT_THAT(mesh.warnings, ElementsAre(Field(&SourceWarning::example, HasSubstr("missing.png"))));
  EXPECT_EQ(mesh.materials.at(0).base_color[0], grey_without_image);
  EXPECT_EQ(mesh.materials.at(0).texture.image, -1);
}

TEST_F(PlyMesh, CountsPointsLinesAndKeepsNumbersThatAreNone) {
  EXPECT_EQ(read("ply\nformat ascii 1.0\nelement vertex 4\n" + xyz + "end_header\n" + square).counts.skipped_points,
            4u);
  const TileMesh mesh = read(ascii("4", "4", "nan 0 0\n1 inf 0\n1 1 0\n0 1 -1e999\n3 0 1 2\n2 0 1\n1 3\n0\n"));
  EXPECT_EQ(mesh.counts.triangles, 1u);
  EXPECT_EQ(mesh.counts.skipped_lines, 1u);
  EXPECT_EQ(mesh.counts.skipped_points, 1u);
  EXPECT_TRUE(std::isnan(mesh.primitives.at(0).position.at(0)));
}

TEST_F(PlyMesh, KeepsMillimetresOfProjectedCoordinates) {
  const TileMesh mesh = read(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face "
      "1\n" +
          faces + "end_header\n447000.123 5412000.457 812.25\n447010.124 5412000 812\n447000 5412010 812\n3 0 1 2\n",
      {true, {}, UpAxis::z});
  const float* p = mesh.primitives[0].position.data();
  const Point<Scene> q = mesh.instances[0].scene_from_local({p[0], p[1], p[2]});
  EXPECT_NEAR(q.x, 447000.123, 1e-6);
  EXPECT_NEAR(q.y, 5412000.457, 1e-6);
  EXPECT_EQ(mesh.primitives[0].position_step, 0);
  const TileMesh floats = read(ascii("3", "1", "447000 5412000 0\n447001 5412000 0\n447000 5412001 0\n3 0 1 2\n"));
  EXPECT_EQ(floats.primitives[0].position_step, 0.5f) << "between floats of 5,412,000";
}

TEST_F(PlyMesh, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(refusal("plum\n"), HasSubstr("line 1: expected a PLY"));
  EXPECT_THAT(refusal("ply\nformat ascii 2.0\n"), HasSubstr("line 2: expected PLY 1.0"));
  EXPECT_THAT(refusal("ply\nformat text 1.0\n"), HasSubstr("line 2: expected the format"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\n"), HasSubstr("no \"end_header\""));
  EXPECT_THAT(refusal("ply\nelement vertex 0\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nelement vertex many\n"),
              HasSubstr("line 3: expected the number of elements"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty bits x\n"),
              HasSubstr("line 4: expected a PLY type"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nelement face 1\nproperty list float int a\n"), HasSubstr("integer type"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n"),
              HasSubstr("x, y and z"));
  EXPECT_THAT(refusal(ascii("4", "1", square + "3 0 1\n")), HasSubstr("the file ends"));
  EXPECT_THAT(refusal(ascii("4", "1", square + "x 0 1 2\n")), HasSubstr("expected a number, got 'x'"));
  EXPECT_THAT(refusal(ascii("4", "1", square + "999999999 0 1\n")), HasSubstr("the length of a list"));
  EXPECT_THAT(refusal(ascii("400000000000", "1", square)), HasSubstr("more than the file can hold"));
  EXPECT_THAT(refusal(ascii("4", "18446744073709551615", square)), HasSubstr("more than the file can hold"));
}

TEST_F(PlyMesh, SaysTheByteWhereABinaryFileIsWrong) {
  Body body(false);
  body.put<float>({0, 0, 0, 1, 0, 0, 1, 1, 0}).put<std::uint8_t>({3}).put<std::int32_t>({0, 1, 9});
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\n" + xyz + "element face 1\n" + faces + "end_header\n";
  const TileMesh mesh = read(header + body.text);
  EXPECT_EQ(mesh.counts.triangles, 0u);
  EXPECT_THAT(ply_lines_of(mesh),
              ElementsAre("loss: faces left out, since a corner refers to no vertex: 1, e.g. byte " +
                          std::to_string(header.size() + 36 + 13)));
  EXPECT_THAT(refusal(header + body.text.substr(0, 20)), HasSubstr("more than the file can hold"));
  EXPECT_THAT(refusal(header + body.text.substr(0, 45)), HasSubstr("fits in the file"));
}

/// 2026-11-25: a file was refused because of one wrong index.
TEST_F(PlyMesh, LeavesOutOneBadFace) {
  const TileMesh mesh = read(ascii("4", "3", square + "3 0 1 4\n3 0 1 2\n3 0 1 -1\n"));
  EXPECT_EQ(mesh.counts.triangles, 1u);
  EXPECT_THAT(ply_lines_of(mesh),
              ElementsAre("loss: faces left out, since a corner refers to no vertex: 2, e.g. line 14"));
}

/// 2026-11-25: colours of faces were ignored, and the mesh was white.
TEST_F(PlyMesh, ReadsColoursOfFaces) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\n" + xyz + "element face 2\n" + faces +
      "property uchar Red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nend_header\n";
  for (const char* alpha : {" 255\n", " 0\n"}) {
    const TileMesh mesh = read(head + square + "3 0 1 2 255 0 0" + alpha + "3 0 2 3 0 255 0" + alpha);
    ASSERT_EQ(mesh.primitives.size(), 1u);
    EXPECT_THAT(std::vector(mesh.primitives[0].rgba.begin() + 8, mesh.primitives[0].rgba.begin() + 16),
                ElementsAre(65535, 0, 0, 65535, 0, 65535, 0, 65535));
    EXPECT_EQ(mesh.warnings.size(), alpha[1] == '0' ? 1u : 0u);
  }
}

/// 2026-11-25: a mesh whose vertices all have alpha 0 was invisible. Programs without support for alpha write zeros.
TEST_F(PlyMesh, IsOpaqueIfAlphaIsZeroEverywhere) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz +
                           "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
                           "element face 1\n" +
                           faces + "end_header\n";
  const TileMesh mesh = read(head + "0 0 0 255 0 0 0\n1 0 0 255 0 0 0\n0 1 0 255 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(mesh.primitives.at(0).rgba.at(3), 65535);
  EXPECT_EQ(mesh.materials.at(0).alpha_mode, AlphaMode::opaque);
  EXPECT_THAT(ply_lines_of(mesh), ElementsAre(HasSubstr("alpha is 0 everywhere, taken as opaque")));
  const TileMesh blended = read(head + "0 0 0 255 0 0 0\n1 0 0 255 0 0 9\n0 1 0 255 0 0 0\n3 0 1 2\n");
  EXPECT_EQ(blended.primitives.at(0).rgba.at(3), 0);
  EXPECT_EQ(blended.materials.at(0).alpha_mode, AlphaMode::blend);
}

/// 2026-11-25: only "TextureFile" was understood, and only line feeds ended the header's lines.
TEST_F(PlyMesh, ReadsOtherSpellings) {
  folder.write("one.png", ply_png_head);
  std::string text =
      "\xEF\xBB\xBFply\nformat ascii 1.0\ncomment TEXTUREFILE C:\\scans\\one.png\nelement vertex 3\n" + xyz +
      "property float s\nproperty float t\nproperty float flavour\nelement face 1\n" + faces +
      "element edge 1\nproperty int vertex1\nend_header\n0 0 0 0.5 1 1\n1 0 0 0 0 1\n0 1 0 1 0 1\n3 0 1 2\n7\n";
  for (const char* line_end : {"\n", "\r", "\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? std::string(line_end) : std::string(1, c);
    const TileMesh mesh = read(other);
    EXPECT_EQ(mesh.counts.triangles, 1u);
    EXPECT_EQ(mesh.materials.at(0).texture.image, 0);
    EXPECT_THAT(ply_lines_of(mesh), ElementsAre("properties that are not used: 1, e.g. 'flavour'",
                                                "elements that are not read: 1, e.g. 'edge'"));
  }
}

/// 2026-11-25: one far vertex moved the origin. The other vertices then lost precision, or the mesh disappeared.
TEST_F(PlyMesh, KeepsItsPrecisionWithOneFarVertex) {
  for (const char* far : {"0 0 0", "1e9 1e9 1e9", "1e300 0 0"}) {
    const TileMesh mesh = read(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
        "property double z\nelement face 1\n" +
        faces + "end_header\n" + far + "\n447000.123 5412000.457 0\n447010 5412000 0\n447000 5412010 0\n3 1 2 3\n");
    ASSERT_EQ(mesh.primitives.size(), 1u);
    const float* p = mesh.primitives[0].position.data();
    EXPECT_NEAR(mesh.instances[0].scene_from_local({p[0], p[1], p[2]}).x, 447000.123, 1e-6) << far;
  }
}

}  // namespace
}  // namespace gigabake
