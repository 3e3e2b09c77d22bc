/// Normal maps of MTL: `norm`, and `bump` where its image is not grey.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "format/source/image/grey_image.h"
#include "format/source/image/png_bytes.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "mesh_file.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Returns a PNG of 2 × 2: three grey texels, then one of the given colour.
std::string png_with_texel(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  const std::vector<std::uint8_t> texels{0, 0, 0, 255, 255, 255, 90, 90, 90, r, g, b};
  const std::vector<std::uint8_t> bytes = png_bytes("test", 2, 2, texels);
  return {bytes.begin(), bytes.end()};
}

class ObjNormalMaps : public test::MeshFile {
 protected:
  ObjNormalMaps() : MeshFile("a.obj") {
    folder.write("normal.png", png_with_texel(128, 128, 255));
    folder.write("height.png", png_with_texel(200, 190, 180));
  }
  /// Returns a triangle with the lines of a material.
  TileMesh with_material(const std::string& lines, const std::string& face = "f 1/1 2/2 3/3\n") {
    folder.write("m.mtl", "newmtl m\n" + lines);
    return read("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\n" + face);
  }
  static std::vector<std::string> warnings_of(const TileMesh& mesh) {
    std::vector<std::string> lines;
    for (const SourceWarning& w : mesh.warnings) lines.push_back(w.line());
    return lines;
  }
};

TEST_F(ObjNormalMaps, AreReadInAnyOfTheirSpellings) {
  for (const std::string key : {"norm", "map_Norm", "bump", "map_Bump", "MAP_BUMP"}) {
    const TileMesh mesh = with_material(key + " -bm 0.5 -clamp on normal.png\n");
    const NormalMap& map = mesh.materials.at(0).normal_map;
    EXPECT_EQ(map.texture.image, 0) << key;
    EXPECT_EQ(map.texture.wrap_s, Wrap::clamp_to_edge);
    EXPECT_EQ(map.scale, 0.5f);
    EXPECT_EQ(mesh.materials.at(0).texture.image, -1);
    EXPECT_TRUE(mesh.primitives.at(0).shares_uv);
    EXPECT_THAT(warnings_of(mesh), IsEmpty());
  }
  const TileMesh both = with_material("norm normal.png\nbump height.png\n");
  EXPECT_EQ(both.materials.at(0).normal_map.texture.image, 0) << "norm has precedence";
  EXPECT_THAT(warnings_of(both), IsEmpty());
}

TEST_F(ObjNormalMaps, MayHaveAnotherPlacementThanTheColour) {
  const Primitive p = with_material("map_Kd -s 2 2 height.png\nnorm -o 0.5 0.25 normal.png\n").primitives.at(0);
  EXPECT_FALSE(p.shares_uv);
  EXPECT_THAT(p.uv, ElementsAre(0, 1, 2, 1, 0, -1));
  EXPECT_THAT(p.normal_uv, ElementsAre(0.5f, 0.75f, 1.5f, 0.75f, 0.5f, -0.25f));
}

TEST_F(ObjNormalMaps, ThatAreHeightsAreReportedAndNotUsed) {
  const TileMesh mesh = with_material("bump height.png\n");
  EXPECT_EQ(mesh.materials.at(0).normal_map.texture.image, -1);
  EXPECT_FALSE(mesh.primitives.at(0).shares_uv);
  EXPECT_THAT(warnings_of(mesh),
              ElementsAre("grey or damaged images in place of normal maps (height maps), not used: 1, e.g. "
                          "'height.png'"));
  folder.write("cut.png", png_with_texel(128, 128, 255).substr(0, 50));
  EXPECT_EQ(warnings_of(with_material("norm cut.png\n")).size(), 1u);
}

TEST_F(ObjNormalMaps, ThatAreMissingAreReported) {
  EXPECT_THAT(warnings_of(with_material("norm no.png\n")),
              ElementsAre("normal maps (norm, bump) that are missing or no PNG, JPEG or WebP, not used: 1, e.g. "
                          "'no.png'"));
}

TEST_F(ObjNormalMaps, WithoutCoordinatesAreReportedAndNotUsed) {
  const TileMesh mesh = with_material("norm normal.png\n", "f 1 2 3\n");
  EXPECT_EQ(mesh.materials.at(0).normal_map.texture.image, -1);
  EXPECT_THAT(warnings_of(mesh),
              ElementsAre("normal maps without the texture coordinates that they require, not used: 1, e.g. 'm'"));
}

TEST_F(ObjNormalMaps, ArePartOfTheTilesHash) {
  with_material("norm normal.png\n");
  const Hash128 before = tile_hash(sources.tiles.at(0), sources.root);
  folder.write("normal.png", png_with_texel(0, 128, 255));
  EXPECT_NE(tile_hash(sources.tiles.at(0), sources.root), before);
}

TEST(GreyImages, HaveNoColouredTexel) {
  const auto is_grey_png = [](const std::string& png) { return is_grey({"test", {png.begin(), png.end()}}); };
  EXPECT_TRUE(is_grey_png(png_with_texel(200, 190, 180)));
  EXPECT_FALSE(is_grey_png(png_with_texel(128, 128, 255)));
}

}  // namespace
}  // namespace gigabake
