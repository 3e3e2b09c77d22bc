#include "format/export/gigavoxels/gigavoxel.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/math/octahedral.h"
#include "format/export/gigavoxels/gigavoxel_bricks.h"
#include "format/export/gigavoxels/gigavoxel_read.h"
#include "tests/format/scene/scene_voxels.h"
#include "tests/format/shard/made_shard.h"
#include "tests/format/system/small_disk.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using made::TempFolder;
using Files = std::vector<std::filesystem::path>;

constexpr GigavoxelTreeFile both_kinds[] = {GigavoxelTreeFile::xml, GigavoxelTreeFile::binary};

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

template <class T>
T value_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

struct ReadVoxel {
  std::array<std::uint8_t, 4> rgba{};
  GradientBytes gradient{};
};
using ReadVoxels = std::map<Vec3i64, ReadVoxel>;

/// Returns the voxels of all trees of a scene, keyed by their position on the lattice of the level.
ReadVoxels read_back(const std::filesystem::path& folder, const SceneDescription& scene, int lod) {
  ReadVoxels voxels;
  const Files trees = gigavoxel_tree_files(folder / "scene.gvp");
  EXPECT_EQ(trees.size(), scene.cells.size());
  for (std::size_t i = 0; i < trees.size(); ++i) {
    const GigavoxelTree tree = read_gigavoxel_tree(trees[i]);
    const SceneCell& cell = scene.cells[i];
    const std::uint32_t depth = cell.lods - 1 - std::uint32_t(lod);
    EXPECT_EQ(tree.header.corner_m, scene.lattice_origin_m + Vec3d(cell.lattice_min) * scene.voxel_size_m);
    for_each_gigavoxel(tree, depth, trees[i].parent_path() / ("voxels_" + std::to_string(depth) + ".gvb"),
                       [&](const GigavoxelBox& box) {
                         for (std::uint64_t z = 0; z < box.extent[2]; ++z)
                           for (std::uint64_t y = 0; y < box.extent[1]; ++y)
                             for (std::uint64_t x = 0; x < box.extent[0]; ++x)
                               voxels[(cell.lattice_min >> lod) +
                                      Vec3i64{std::int64_t(box.lowest[0] + x), std::int64_t(box.lowest[1] + y),
                                              std::int64_t(box.lowest[2] + z)}] = {box.rgba, box.gradient};
                       });
  }
  return voxels;
}

void expect_same(const ReadVoxels& read, const made::SceneVoxels& voxels, bool normals) {
  ASSERT_EQ(read.size(), voxels.size());
  for (const auto& [at, voxel] : voxels) {
    ASSERT_TRUE(read.contains(at));
    EXPECT_EQ(read.at(at).rgba, voxel.rgba);
    const Vec3<float> n = unit_normal(voxel.normal.data());
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(read.at(at).gradient[c] / 127.5 - 1, normals ? n[c] : 0, 0.5 / 127.5 + 1e-6);
  }
}

TEST(Gigavoxel, AScenesVoxelsComeBackFromBothKindsOfTrees) {
  for (int round = 0; round < 4; ++round) {
    const made::RandomScene scene(round);
    const int finest = round % 2;
    for (const GigavoxelTreeFile kind : both_kinds) {
      const std::filesystem::path out = scene / ("out" + std::to_string(int(kind)));
      EXPECT_EQ(export_gigavoxel(scene.xml(), finest, out, kind), scene.voxels(finest).size());
      for (int lod = finest; lod < 4; ++lod)
        expect_same(read_back(out, scene.description(), lod), scene.voxels(lod), scene.description().has_normals);
    }
  }
}

TEST(Gigavoxel, ABricksBorderHoldsItsNeighboursAndIsEmptyOutsideOfTheCell) {
  const TempFolder folder;
  std::vector<made::Voxel> voxels;
  for (std::int64_t x = 0; x < 16; ++x)
    for (std::int64_t y = 0; y < 16; ++y) voxels.push_back({{x, y, 7}, {std::uint8_t(x), std::uint8_t(y), 9, 255}, {}});
  made::write_scene_of(folder / "scene.xml", {made::shard_of(voxels, {0, 0, 0}, 16)});
  export_gigavoxel(folder / "scene.xml", 0, folder / "out", GigavoxelTreeFile::binary);
  const GigavoxelBrickFile bricks(folder / "out/grid_0/voxels_1.gvb", {8, 8, 8});
  ASSERT_EQ(bricks.size(), 4u);
  const GigavoxelBrickData brick = bricks.read(0);
  for (std::int64_t z = -1; z < 9; ++z)
    for (std::int64_t y = -1; y < 9; ++y)
      for (std::int64_t x = -1; x < 9; ++x) {
        const std::size_t i = std::size_t((z + 1) * 100 + (y + 1) * 10 + x + 1);
        const bool there = z == 7 && x >= 0 && y >= 0;
        EXPECT_EQ(brick.rgba[4 * i + 3], there ? 255 : 0);
        EXPECT_EQ(brick.rgba[4 * i], there ? x : 0);
        EXPECT_EQ(brick.rgba[4 * i + 1], there ? y : 0);
      }
}

TEST(Gigavoxel, TheBinaryTreesBytesAreThoseOfTheDocument) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  export_gigavoxel(folder / "scene.xml", 0, folder / "out", GigavoxelTreeFile::binary);
  const std::string tree = made::bytes_of(folder / "out/grid_0/tree.gvo");
  ASSERT_EQ(tree.size(), 96 + 2 * 96u);
  EXPECT_EQ(tree.substr(0, 8), "GVOCTREE");
  EXPECT_EQ(value_at<std::uint32_t>(tree, 8), 1u);
  EXPECT_EQ(value_at<std::uint32_t>(tree, 12), 2u);          // levels
  EXPECT_EQ(value_at<double>(tree, 16), 100.5 - 16 * 0.25);  // X
  EXPECT_EQ(value_at<double>(tree, 40), 0.25);               // DeltaX
  EXPECT_EQ(value_at<std::uint32_t>(tree, 64), 16u);         // VolumeXSize
  EXPECT_EQ(value_at<std::uint32_t>(tree, 76), 8u);          // BrickXSize
  EXPECT_EQ(value_at<std::uint32_t>(tree, 88), 0u);          // uncompressed
  EXPECT_EQ(value_at<std::uint32_t>(tree, 92), 2u);          // blocks
  EXPECT_EQ(value_at<std::uint32_t>(tree, 96), 1u);          // the root: brick 0, children in block 1
  EXPECT_EQ(value_at<std::uint32_t>(tree, 100), 0u);
  EXPECT_EQ(value_at<std::uint32_t>(tree, 96 + 8 * 8), 0u);        // child 0: brick 0
  EXPECT_EQ(value_at<std::uint32_t>(tree, 96 + 9 * 8), 1u << 30);  // child 1: empty
  EXPECT_EQ(value_at<std::uint32_t>(tree, 96 + 14 * 8), 1u << 30);
  EXPECT_EQ(value_at<std::uint32_t>(tree, 100 + 14 * 8), 0xff204080u);
  const std::string bricks = made::bytes_of(folder / "out/grid_0/voxels_1.gvb");
  ASSERT_EQ(bricks.size(), 4 + 7052u);
  EXPECT_EQ(value_at<std::uint64_t>(bricks, 4), 10u);
  EXPECT_EQ(value_at<std::uint32_t>(bricks, 28), 1u);
  EXPECT_EQ(value_at<std::uint32_t>(bricks, 44), 4000u);
  EXPECT_EQ(value_at<std::uint32_t>(bricks, 48 + 4000 + 4), 3000u);
}

TEST(Gigavoxel, AColourInXmlIsTheByteForReadersThatRoundAndForThoseThatCutOff) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  export_gigavoxel(folder / "scene.xml", 0, folder / "out", GigavoxelTreeFile::xml);
  const std::string xml = made::bytes_of(folder / "out/grid_0/tree.gvx");
  for (const auto& [key, byte] : {std::pair("ColorR=\"", 0x80), {"ColorG=\"", 0x40}, {"ColorB=\"", 0x20}}) {
    float share = -1;
    for (std::size_t at = 0; (at = xml.find(key, at)) != std::string::npos && share <= 0; ++at)
      share = std::stof(xml.substr(at + std::strlen(key)));
    EXPECT_EQ(int(share * 255.0f), byte);
    EXPECT_EQ(std::lround(share * 255), byte);
  }
}

TEST(Gigavoxel, TreesOfTheThesissOwnProgramsCanBeRead) {
  const TempFolder folder;
  write_bytes(folder / "root.gvp",
              "<OctTrees Compressed='NO' BrickXSize='8' BrickYSize='8' BrickZSize='8' >\n"
              "<OctTree CenterX=\"1\" CenterY=\"1\" CenterZ=\"1\" Radius=\"2\" TreeFile=\"grid_0_0_0/tree.gvx\" />"
              "</OctTrees>");
  std::filesystem::create_directory(folder / "grid_0_0_0");
  write_bytes(folder / "grid_0_0_0/tree.gvx",
              "<GigaVoxelsOctTree MaxDepth=\"1\" X=\"0\" Y=\"0\" Z=\"0\" DeltaX=\"0.5\" DeltaY=\"0.5\" DeltaZ=\"0.5\" "
              "VolumeXSize=\"2\" VolumeYSize=\"2\" VolumeZSize=\"2\" BrickXSize=\"2\" BrickYSize=\"2\" "
              "BrickZSize=\"2\" Binary=\"YES\" Compressed=\"NO\" >\n<Node MipMapX=\"0\" MipMapY=\"0\" MipMapZ=\"0\" "
              "Type=\"CONST\" ColorR=\"0.501961\" ColorG=\"0\" ColorB=\"1\" ColorA=\"1\" Depth=\"0\" />\n"
              "</GigaVoxelsOctTree>");
  const Files trees = gigavoxel_tree_files(folder / "root.gvp");
  ASSERT_EQ(trees.size(), 1u);
  int boxes = 0;
  for_each_gigavoxel(read_gigavoxel_tree(trees[0]), 0, folder / "none", [&](const GigavoxelBox& box) {
    ++boxes;
    EXPECT_EQ(box.extent, (Vec3<std::uint64_t>{2, 2, 2}));
    EXPECT_EQ(box.rgba, (std::array<std::uint8_t, 4>{128, 0, 255, 255}));
  });
  EXPECT_EQ(boxes, 1);
}

TEST(Gigavoxel, IsNotWrittenOverAFolderWithFilesNorWhereAShardIsDamagedOrTheDiskIsFull) {
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::small_shard()});
  const auto entries = [&] { return std::distance(std::filesystem::directory_iterator(folder.path()), {}); };
  const auto write = [&] { export_gigavoxel(folder / "scene.xml", 0, folder / "out/", GigavoxelTreeFile::xml); };
  {
    const SmallDisk disk(6000);
    EXPECT_THROW(write(), InputError);
  }
  EXPECT_EQ(entries(), 2);
  write();
  EXPECT_THROW(write(), InputError);
  std::filesystem::remove_all(folder / "out");
  EXPECT_THROW(export_gigavoxel(folder / "scene.xml", 2, folder / "out", GigavoxelTreeFile::xml), InputError);
  EXPECT_THROW(export_gigavoxel(folder / "scene.xml", 0, folder / "no/out", GigavoxelTreeFile::xml), InputError);
  std::filesystem::resize_file(folder / "shards/c_0_0_0.h5", 100);
  EXPECT_THROW(write(), InputError);
  EXPECT_EQ(entries(), 2);
}

/// Reads the whole tree. Returns false if the reader refuses it.
bool is_read(const std::filesystem::path& tree_file) {
  try {
    const GigavoxelTree tree = read_gigavoxel_tree(tree_file);
    for (std::uint32_t depth = 0; depth < tree.header.max_depth; ++depth)
      for_each_gigavoxel(tree, depth, tree_file.parent_path() / ("voxels_" + std::to_string(depth) + ".gvb"),
                         [](const GigavoxelBox&) {});
    return true;
  } catch (const InputError&) {
    return false;
  }
}

TEST(GigavoxelHostile, AnyByteOfAnyFileMayBeWrongOrMissing) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  made::write_scene_of(folder / "scene.xml", {made::random_shard(rng, {3, true, 2})});
  for (const GigavoxelTreeFile kind : both_kinds) {
    const std::filesystem::path out = folder / ("out" + std::to_string(int(kind)));
    export_gigavoxel(folder / "scene.xml", 0, out, kind);
    const std::filesystem::path tree = gigavoxel_tree_files(out / "scene.gvp").at(0);
    EXPECT_TRUE(is_read(tree));
    for (const std::filesystem::path& file : {tree, out / "grid_0/voxels_2.gvb"}) {
      const std::string whole = made::bytes_of(file);
      for (int i = 0; i < 200; ++i) {
        std::string bytes = whole;
        if (i % 4 == 0)
          bytes.resize(rng() % (whole.size() - 1));
        else if (i % 4 == 1)
          bytes.insert(rng() % whole.size(), 1, char(rng()));
        else
          bytes[i % 4 == 2 ? rng() % std::min<std::size_t>(whole.size(), 300) : rng() % whole.size()] = char(rng());
        write_bytes(file, bytes);
        const bool read = is_read(tree);
        EXPECT_FALSE(i % 4 == 0 && read && file == tree) << "a tree of " << bytes.size() << " bytes";
      }
      write_bytes(file, whole);
    }
  }
}

TEST(GigavoxelHostile, ElementsMayNestDeeperThanAnyTree) {
  const TempFolder folder;
  std::string xml =
      "<GigaVoxelsOctTree MaxDepth=\"2\" X=\"0\" Y=\"0\" Z=\"0\" DeltaX=\"1\" DeltaY=\"1\" DeltaZ=\"1\" "
      "VolumeXSize=\"16\" VolumeYSize=\"16\" VolumeZSize=\"16\" BrickXSize=\"8\" BrickYSize=\"8\" "
      "BrickZSize=\"8\">";
  for (int i = 0; i < 200000; ++i) xml += "<Node Depth=\"" + std::to_string(i) + "\" Type=\"NON-CONST\" Brick=\"0\">";
  for (int i = 0; i < 200000; ++i) xml += "</Node>";
  write_bytes(folder / "tree.gvx", xml + "</GigaVoxelsOctTree>");
  EXPECT_THROW(read_gigavoxel_tree(folder / "tree.gvx"), InputError);
}

TEST(GigavoxelHostile, ATreeMayNotBeOutsideOfItsScenesFolder) {
  const TempFolder folder;
  for (const char* file : {"../tree.gvx", "/etc/passwd", "a/../../tree.gvx", ""}) {
    write_bytes(folder / "scene.gvp",
                std::string("<OctTreeGroup><PagedOctTree TreeFile=\"") + file + "\"/></OctTreeGroup>");
    EXPECT_THROW(gigavoxel_tree_files(folder / "scene.gvp"), InputError);
  }
}

}  // namespace
}  // namespace gigabake
