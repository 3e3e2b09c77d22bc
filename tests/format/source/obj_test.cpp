#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "mesh_file.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

class Obj : public test::MeshFile {
 protected:
  Obj() : MeshFile("a.obj") {}
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
};

const std::string png_head = "\x89PNG\r\n\x1a\n, not looked at";

std::vector<std::string> lines_of(const TileMesh& mesh) {
  std::vector<std::string> lines;
  for (const SourceWarning& w : mesh.warnings) lines.push_back((w.is_loss ? "loss: " : "") + w.line());
  return lines;
}

TEST_F(Obj, ReadsFacesOfAnyNumberOfCornersAndNegativeIndices) {
  const TileMesh mesh = read(square + "f 1 2 3 4\nf -4//7 -3 -2\n");
  EXPECT_EQ(mesh.counts.triangles, 3u);
  ASSERT_EQ(mesh.primitives.size(), 1u);
  EXPECT_THAT(mesh.primitives[0].index, ElementsAre(0, 1, 2, 0, 2, 3, 0, 1, 2));
  EXPECT_EQ(mesh.primitives[0].position.size(), 12u);
}

TEST_F(Obj, IsYUpUnlessToldOtherwise) {
  EXPECT_EQ(read(square + "f 1 2 3\n").instances[0].scene_from_local({0, 1, 0}), (Point<Scene>{0, 0, 1}));
  EXPECT_EQ(read(square + "f 1 2 3\n", {true, {}, UpAxis::z}).instances[0].scene_from_local({0, 1, 0}),
            (Point<Scene>{0, 1, 0}));
}

TEST_F(Obj, KeepsMillimetresOfProjectedCoordinates) {
  const TileMesh mesh =
      read("v 447000.123 5412000.457 812.25\nv 447010.124 5412000 812\nv 447000 5412010 812\nf 1 2 3\n",
           {true, {}, UpAxis::z});
  const float* p = mesh.primitives[0].position.data();
  const Point<Scene> q = mesh.instances[0].scene_from_local({p[0], p[1], p[2]});
  EXPECT_NEAR(q.x, 447000.123, 1e-6);
  EXPECT_NEAR(q.y, 5412000.457, 1e-6);
  EXPECT_NEAR(q.z, 812.25, 1e-6);
}

TEST_F(Obj, ReadsMaterialsAndTheirImages) {
  folder.write("sub dir/a b.mtl", std::string("newmtl red one\nKd 1 0.5 0\nd 0.25\nnewmtl leaf\nKd 0 0 0\n"
                                              "map_Kd -s 1 1 1 -clamp on ..\\leaf.png\n"));
  folder.write("leaf.png", png_head);
  const std::string text =
      "mtllib sub dir/a b.mtl\n" + square +
      "vt 0.25 0.75\nvt 1 1\nusemtl red one\nf 1 2 3\nusemtl leaf\nf 1/1 2/2 \\\n 3/1\nusemtl none\n"
      "f 1 2 4\n";
  const TileMesh mesh = read(text);
  ASSERT_EQ(mesh.primitives.size(), 3u);  // sorted by name: leaf, none, red one
  const Material leaf = mesh.materials.at(0), none = mesh.materials.at(1), red = mesh.materials.at(2);
  EXPECT_THAT(red.base_color, ElementsAre(1, 0.5f, 0, 0.25f));
  EXPECT_EQ(red.alpha_mode, AlphaMode::blend);
  EXPECT_THAT(leaf.base_color, ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(leaf.texture.image, 0);
  EXPECT_EQ(none.texture.image, -1);
  EXPECT_THAT(mesh.primitives[0].uv, ElementsAre(0.25f, 0.25f, 1, 0, 0.25f, 0.25f));
  const TileIdentity identity = identify_tile(sources.tiles[0], sources.root);
  EXPECT_EQ(identity.files.size(), 3u);
  folder.write("leaf.png", png_head + "another");
  EXPECT_NE(tile_hash(sources.tiles[0], sources.root), identity.hash);
}

/// 2026-11-22: a file was refused if its material file was missing.
TEST_F(Obj, IsGreyWithAWarningWhereItsMaterialFileIsMissing) {
  const TileMesh mesh = read("mtllib gone.mtl\n" + square + "usemtl a\nf 1 2 3\n");
  EXPECT_THAT(mesh.warnings, ElementsAre(Field(&SourceWarning::example, "'gone.mtl'")));
  EXPECT_EQ(mesh.materials.at(0).base_color[1], grey_without_image);
  const Hash128 hash = tile_hash(sources.tiles[0], sources.root);
  folder.write("gone.mtl", std::string("newmtl a\nKd 1 0 0\n"));
  EXPECT_NE(tile_hash(sources.tiles[0], sources.root), hash);
  const TileMesh red = read("mtllib gone.mtl\n" + square + "usemtl a\nf 1 2 3\n");
  EXPECT_THAT(red.materials.at(0).base_color, ElementsAre(1, 0, 0, 1));
  EXPECT_TRUE(red.warnings.empty());
}

TEST_F(Obj, SaysWhatItIsNot) { EXPECT_THAT(refusal(std::string("v\0 1", 4)), HasSubstr("expected text")); }

/// 2026-11-25: a file was refused because of one bad face.
TEST_F(Obj, LeavesOutOneBadFace) {
  const auto expect = [&](const std::string& bad, const std::string& line) {
    const TileMesh mesh = read(square + bad + "\nf 1 2 3\n");
    EXPECT_EQ(mesh.primitives.at(0).index.size(), 3u) << bad;
    EXPECT_THAT(lines_of(mesh), ElementsAre(line)) << bad;
  };
  expect("f 1 2 5", "loss: faces left out, since a corner refers to no vertex: 1 of 2, e.g. line 5");
  expect("f 1 2 0", "loss: faces left out, since a corner refers to no vertex: 1 of 2, e.g. line 5");
  expect("f 99999999999999999999 1 2", "loss: faces left out, since a corner refers to no vertex: 1 of 2, e.g. line 5");
  expect("f -5 1 2", "loss: faces left out, since a corner refers to no vertex: 1 of 2, e.g. line 5");
  expect("f a b c", "loss: faces left out, since a corner is not a number: 1 of 2, e.g. line 5");
  expect("v 1 2", "loss: vertices without three coordinates, whose faces are left out: 1, e.g. line 5");
  expect("flavour 7", "lines not understood: 1, e.g. line 5");
  expect("curv2 1 2", "lines of free-form curves and surfaces, which are not baked: 1, e.g. line 5");
  expect("mtllib ../../../etc/passwd",
         "material files are missing, their materials are grey: 1, e.g. '../../../etc/passwd'");
}

/// 2026-11-25: a file was refused because of a face with one or two corners.
TEST_F(Obj, CountsFacesOfOneAndTwoCorners) {
  const TileMesh mesh = read(square + "f 1\nf 1 2\nf 1 2 3 # a comment\nfo 1 3 4\nl 1 2 3 # three\n");
  EXPECT_EQ(mesh.counts.triangles, 2u);
  EXPECT_EQ(mesh.counts.skipped_points, 1u);
  EXPECT_EQ(mesh.counts.skipped_lines, 3u);
  EXPECT_TRUE(mesh.warnings.empty());
}

/// 2026-11-25: a byte order mark hid the first line, and carriage returns without line feeds made the file one line.
TEST_F(Obj, ReadsOtherLineEndsAndAByteOrderMark) {
  folder.write("m.mtl", std::string("\xEF\xBB\xBFnewmtl a\rKd 1 0 0\r"));
  const std::string text = "\xEF\xBB\xBFmtllib m.mtl\n" + square + "usemtl a\nf 1 2 \\\n3\nf 1 3 9\n";
  for (const char* line_end : {"\n", "\r", "\r\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? std::string(line_end) : std::string(1, c);
    const TileMesh mesh = read(other);
    EXPECT_EQ(mesh.counts.triangles, 1u);
    EXPECT_THAT(mesh.materials.at(0).base_color, ElementsAre(1, 0, 0, 1));
    EXPECT_THAT(lines_of(mesh), ElementsAre(HasSubstr("e.g. line 9")));
  }
}

/// 2026-11-25: if some faces had no texture coordinates or colours, no face used any.
TEST_F(Obj, UsesWhatAFaceHas) {
  folder.write("m.mtl", std::string("newmtl a\nmap_Kd t.png\n"));
  folder.write("t.png", png_head);
  const TileMesh mesh = read("mtllib m.mtl\n" + square +
                             "v 5 0 0 1 0 0\nv 6 0 0 1 0 0\nv 6 1 0 1 0 0\nvt 0 0\nusemtl a\n"
                             "f 1/1 2/1 3/1\nf 1 3 4\nf 5/1 6/1 7/1\nf 1 5 6\n");
  ASSERT_EQ(mesh.primitives.size(), 3u);
  EXPECT_THAT(lines_of(mesh),
              ElementsAre("faces without vertex colours, in a file that has some: 3 of 4, e.g. line 11",
                          "faces without texture coordinates, of materials with an image: 2 of 4, e.g. line 12"));
  const auto shown = [&](std::size_t p) {
    return mesh.materials.at(std::size_t(mesh.primitives[p].material)).texture.image;
  };
  EXPECT_EQ(shown(0), -1);
  EXPECT_EQ(mesh.primitives[0].index.size(), 6u);
  EXPECT_EQ(shown(1), 0);
  EXPECT_TRUE(mesh.primitives[1].rgba.empty());
  EXPECT_EQ(shown(2), 0);
  EXPECT_THAT(std::vector(mesh.primitives[2].rgba.begin(), mesh.primitives[2].rgba.begin() + 4),
              ElementsAre(65535, 0, 0, 65535));
}

/// 2026-11-25: only one spelling of each MTL keyword was understood.
TEST_F(Obj, ReadsMaterialsAsExportersWriteThem) {
  const auto material = [&](const std::string& text) {
    folder.write("m.mtl", "newmtl a\n" + text);
    return read("mtllib m.mtl\nmtllib\n" + square + "vt 0.25 0.5\nusemtl a\nf 1/1 2/1 3/1\n");
  };
  folder.write("t.png", png_head);
  EXPECT_THAT(material("Kd 0.5\n").materials.at(0).base_color, ElementsAre(0.5f, 0.5f, 0.5f, 1));
  EXPECT_THAT(material("KD 1 0 0 # red\n").materials.at(0).base_color, ElementsAre(1, 0, 0, 1));
  EXPECT_EQ(material("Tr 1\n").materials.at(0).base_color[3], 1);
  EXPECT_EQ(material("Tr 0.25\n").materials.at(0).base_color[3], 0.75f);
  EXPECT_EQ(material("d 1\nTr 1\n").materials.at(0).base_color[3], 1);
  EXPECT_EQ(material("Tr 1\nd 0\n").materials.at(0).base_color[3], 0);
  EXPECT_THAT(lines_of(material("Kd 255 0 0\n")), ElementsAre(HasSubstr("colours (Kd) above 1")));
  EXPECT_THAT(lines_of(material("Kd spectral a.rfl\nflavour 1\n")),
              ElementsAre(HasSubstr("MTL lines not understood: 2")));
  for (const char* map : {"map_kd t.png\n", "map_Kd C:\\Users\\me\\t.png\n", "map_Kd /home/me/t.png\n",
                          "map_Kd \"t.png\"\n", "map_Kd -blendu on -bm 1 -mm 0 1 -o 0 0 -texres 512 t.png\n"}) {
    const TileMesh mesh = material(map);
    EXPECT_EQ(mesh.materials.at(0).texture.image, 0) << map;
    EXPECT_TRUE(mesh.warnings.empty()) << map;
  }
  const TileMesh placed = material("map_Kd -s 2 4 1 -o 0.5 0.25 -clamp on t.png\n");
  EXPECT_THAT(placed.primitives.at(0).uv, ElementsAre(1, -1.25f, 1, -1.25f, 1, -1.25f));
  EXPECT_EQ(placed.materials.at(0).texture.wrap_s, Wrap::clamp_to_edge);
}

/// 2026-11-25: a file was refused because of a missing image. Undefined materials were white without a warning.
TEST_F(Obj, IsGreyWithAWarningWhereItsImageIsMissing) {
  folder.write("m.mtl", std::string("newmtl a\nmap_Kd missing.png\nnewmtl b\nmap_Kd text.tga\n"));
  folder.write("text.tga", std::string("no image"));
  const TileMesh mesh = read("mtllib m.mtl\n" + square +
                             "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 4/1\nusemtl b\xE4rk\nf 1 3 4\n");
  EXPECT_THAT(lines_of(mesh), ElementsAre("images are missing, replaced by grey: 1, e.g. 'missing.png'",
                                          "images are not PNG, JPEG or WebP, replaced by grey: 1, e.g. 'text.tga'",
                                          HasSubstr("no file defines, taken as white: 1 of 3")));
  EXPECT_EQ(mesh.materials.at(0).base_color[0], grey_without_image);
  EXPECT_EQ(mesh.materials.at(1).base_color[0], grey_without_image);
  EXPECT_EQ(mesh.materials.at(2).base_color[0], 1);
}

/// 2026-11-25: an unused vertex or one far triangle moved the origin. The other triangles then lost precision or
/// disappeared.
TEST_F(Obj, KeepsItsPrecisionWhateverElseTheFileHas) {
  const std::string utm = "v 447000.123 5412000.457 812.25\nv 447010.124 5412000 812\nv 447000 5412010 812\n";
  for (const char* other : {"v 0 0 0\n", "v 1e9 1e9 1e9\n", "v nan 0 0\n", "v 460000 5400000 0\n"}) {
    const TileMesh mesh = read(other + utm + "f 2 3 4\n", {true, {}, UpAxis::z});
    const float* p = mesh.primitives.at(0).position.data();
    EXPECT_NEAR(mesh.instances.at(0).scene_from_local({p[0], p[1], p[2]}).x, 447000.123, 1e-6) << other;
    EXPECT_LT(std::fabs(p[0]), 100) << other;
  }
  const TileMesh far = read(utm + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 4 5 6\n", {true, {}, UpAxis::z});
  ASSERT_EQ(far.primitives.size(), 2u);
  EXPECT_EQ(far.primitives[0].position.at(3), 1);
  EXPECT_LT(std::fabs(far.primitives[1].position[0]), 100);
}

}  // namespace
}  // namespace gigabake
