#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "lattice/error.h"
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
  folder.write("leaf.png", std::string("not looked at"));
  const std::string text =
      "mtllib sub dir/a b.mtl\n" + square +
      "vt 0.25 0.75\nvt 1 1\nusemtl red one\nf 1 2 3\nusemtl leaf\nf 1/1 2/2 \\\n 3/1\nusemtl none\n"
      "f 1 2 4\n";
  const TileMesh mesh = read(text);
  ASSERT_EQ(mesh.primitives.size(), 3u);  // by name: leaf, none, red one
  const Material leaf = mesh.materials.at(0), none = mesh.materials.at(1), red = mesh.materials.at(2);
  EXPECT_THAT(red.base_color, ElementsAre(1, 0.5f, 0, 0.25f));
  EXPECT_EQ(red.alpha_mode, AlphaMode::blend);
  EXPECT_THAT(leaf.base_color, ElementsAre(1, 1, 1, 1));
  EXPECT_EQ(leaf.texture.image, 0);
  EXPECT_EQ(none.texture.image, -1);
  EXPECT_THAT(mesh.primitives[0].uv, ElementsAre(0.25f, 0.25f, 1, 0, 0.25f, 0.25f));
  const TileIdentity identity = identify_tile(sources.tiles[0], sources.root);
  EXPECT_EQ(identity.files.size(), 3u);
  folder.write("leaf.png", std::string("another"));
  EXPECT_NE(tile_hash(sources.tiles[0], sources.root), identity.hash);
}

/// 2026-11-22: the whole file was refused.
TEST_F(Obj, IsGreyWithAWarningWhereItsMaterialFileIsMissing) {
  const TileMesh mesh = read("mtllib gone.mtl\n" + square + "usemtl a\nf 1 2 3\n");
  EXPECT_THAT(mesh.warnings, ElementsAre(Field(&SourceWarning::text, HasSubstr("'gone.mtl' is missing"))));
  EXPECT_EQ(mesh.materials.at(0).base_color[1], grey_without_image);
  const Hash128 hash = tile_hash(sources.tiles[0], sources.root);
  folder.write("gone.mtl", std::string("newmtl a\nKd 1 0 0\n"));
  EXPECT_NE(tile_hash(sources.tiles[0], sources.root), hash);
  const TileMesh red = read("mtllib gone.mtl\n" + square + "usemtl a\nf 1 2 3\n");
  EXPECT_THAT(red.materials.at(0).base_color, ElementsAre(1, 0, 0, 1));
  EXPECT_TRUE(red.warnings.empty());
}

TEST_F(Obj, SaysWhichLineIsWrong) {
  EXPECT_THAT(refusal(square + "f 1 2 5\n"), HasSubstr("line 5: a corner's index is none of the 4"));
  EXPECT_THAT(refusal(square + "f 1 2\n"), HasSubstr("fewer than three corners"));
  EXPECT_THAT(refusal("v 1 2\n"), HasSubstr("line 1: expected three coordinates"));
  EXPECT_THAT(refusal("f a b c\n"), HasSubstr("expected corners as numbers"));
  EXPECT_THAT(refusal("mtllib ../../../etc/passwd\n"), HasSubstr("leaves the source folder"));
  EXPECT_THAT(refusal(std::string("v\0 1", 4)), HasSubstr("expected text"));
  EXPECT_THAT(refusal(square + "f 99999999999999999999 1 2\n"), HasSubstr("expected corners"));
}

}  // namespace
}  // namespace gigabake
