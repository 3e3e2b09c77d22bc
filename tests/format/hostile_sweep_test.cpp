// Every file of the validators' and importers' collections ends in success or in one clear line. Run this test under
// the sanitizers by ./check, where an invalid read is a failure too.
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "tests/format/source/parts_check.h"
#include "tests/shared_data.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

using test::shared_data;

struct Outcome {
  int read = 0, refused = 0;
};

void expect_one_line(const Path& file, const std::exception& e) {
  const std::string line = e.what();
  EXPECT_FALSE(line.empty()) << file;
  EXPECT_EQ(line.find('\n'), std::string::npos) << file << ": " << line;
  EXPECT_LT(line.size(), 2000u) << file;
}

void read_everything(const Path& file, Outcome& outcome) {
  try {
    const SceneSources sources = open_sources(file, {});
    for (const TileRef& tile : sources.tiles) {
      tile_hash(tile, sources.root);
      test::expect_same_in_parts(tile, sources.root);
      read_tile(tile, sources.root, ReadScope::positions_only);
      for (const EncodedImage& image : read_tile(tile, sources.root, ReadScope::everything).images)
        if (!image.bytes.empty()) decode_image(image);
    }
    ++outcome.read;
  } catch (const InputError& e) {
    expect_one_line(file, e);
    ++outcome.refused;
  }
}

class HostileFiles : public testing::TestWithParam<const char*> {};

TEST_P(HostileFiles, EndInSuccessOrInOneClearLine) {
  const Path folder = shared_data() / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  Outcome outcome;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() &&
        (extension == ".gltf" || extension == ".glb" || extension == ".json" || extension == ".b3dm" ||
         extension == ".i3dm" || extension == ".cmpt" || extension == ".3tz"))
      read_everything(entry.path(), outcome);
  }
  RecordProperty("read", outcome.read);
  RecordProperty("refused", outcome.refused);
  EXPECT_GT(outcome.read + outcome.refused, 0);
}

INSTANTIATE_TEST_SUITE_P(Shared, HostileFiles,
                         testing::Values("gltf-validator-cases", "3dtiles-validator-cases", "nasty-meshes",
                                         "gltf-compressed", "upaxis-tilesets", "cesium-native-tilesets",
                                         "cesiumjs-spec-tiles", "cesium-3dtiles-samples", "gltf-sample-models"),
                         [](const auto& set) {
                           std::string name = set.param;
                           for (char& c : name)
                             if (c == '-') c = '_';
                           return name;
                         });

struct Expected {
  const char* file;
  std::size_t tiles;
  std::uint64_t triangles;
  std::size_t losses;
};

/// The counts come from the READMEs of the data sets and were computed with another parser.
TEST(SharedScenes, HoldTheTrianglesThatTheirReadmesCount) {
  const Expected all[] = {
      {"mars-terrain-3dtiles/tileset.json", 220, 177950, 0},
      {"dem-derived-textured-terrain/santa-barbara-airport/santa-barbara-airport.glb", 1, 522242, 0},
      {"dem-derived-textured-terrain/santa-barbara-airport/tileset.json", 1, 522242, 0},
      {"cesium-3dtiles-samples/1.0/TilesetWithDiscreteLOD/tileset.json", 1, 14782, 1},
  };
  if (!std::filesystem::exists(shared_data())) GTEST_SKIP() << shared_data() << " is absent";
  for (const Expected& e : all) {
    const SceneSources sources = open_sources(shared_data() / e.file, {});
    std::uint64_t triangles = 0;
    for (const TileRef& tile : sources.tiles)
      triangles += read_tile(tile, sources.root, ReadScope::positions_only).counts.triangles;
    EXPECT_EQ(sources.tiles.size(), e.tiles) << e.file;
    EXPECT_EQ(triangles, e.triangles) << e.file;
    EXPECT_EQ(sources.skipped.size(), e.losses) << e.file;
  }
}

}  // namespace
}  // namespace gigabake
