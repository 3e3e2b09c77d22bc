// Files of every format, in which a few bytes are changed at random, are either read or refused in one line. Run this
// test under the sanitizers by ./check.
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "format/system/read_file.h"
#include "tests/format/source/source_scene.h"
#include "tests/random_seed.h"
#include "tests/shared_data.h"

namespace gigabake {
namespace {

using Path = std::filesystem::path;

using test::shared_data;

/// Replaces some bytes, cuts out a piece, or cuts off the end; mostly near the front, which has the file's structure.
void spoil(std::string& bytes, std::mt19937_64& rng) {
  const auto any = [&](std::size_t below) { return std::size_t(rng() % std::max<std::size_t>(below, 1)); };
  const auto place = [&] { return any(rng() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 512) : bytes.size()); };
  const std::size_t changes = 1 + any(4);
  for (std::size_t i = 0; i < changes; ++i) {
    constexpr unsigned char telling[] = {0, 1, 0x7f, 0x80, 0xff};
    bytes[place()] = char(rng() % 2 == 0 ? telling[any(5)] : rng());
  }
  if (rng() % 8 == 0) bytes.erase(place(), 1 + any(16));
  if (rng() % 8 == 0) bytes.resize(1 + any(bytes.size() - 1));
}

void read_all(const Path& file) {
  if (file.extension() == ".webp") {
    decode_image({file.string(), read_whole_file(file)});
    return;
  }
  const SceneSources sources = open_sources(file, {});
  for (const TileRef& tile : sources.tiles) {
    tile_hash(tile, sources.root);
    for (const EncodedImage& image : read_tile(tile, sources.root, ReadScope::everything).images)
      if (!image.bytes.empty()) decode_image(image);
  }
}

/// A file to damage. If `opened` is set, it is a file that refers to `file` and is opened in its place.
struct Sample {
  const char* file;
  const char* opened = nullptr;
  int rounds = 150;
};

class HostileBytes : public testing::TestWithParam<Sample> {};

TEST_P(HostileBytes, EndInSuccessOrInOneClearLine) {
  const Path original = shared_data() / GetParam().file;
  if (!std::filesystem::exists(original)) GTEST_SKIP() << original << " is absent";
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const std::vector<std::uint8_t> bytes = read_whole_file(original);
  const test::SourceFolder folder;
  int read = 0, refused = 0;
  Path opened = folder.path() / original.filename();
  if (GetParam().opened != nullptr) {
    const Path from = (shared_data() / GetParam().opened).parent_path();
    std::filesystem::copy(from, folder.path(), std::filesystem::copy_options::recursive);
    opened = folder.path() / Path(GetParam().opened).filename();
  }
  const Path spoilt =
      GetParam().opened == nullptr
          ? opened
          : folder.path() / original.lexically_relative((shared_data() / GetParam().opened).parent_path());
  for (int round = 0; round < GetParam().rounds; ++round) {
    std::string changed(bytes.begin(), bytes.end());
    if (round != 0) spoil(changed, rng);
    std::ofstream(spoilt, std::ios::binary) << changed;
    try {
      read_all(opened);
      ++read;
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      ++refused;
    }
  }
  RecordProperty("read", read);
  RecordProperty("refused", refused);
}

INSTANTIATE_TEST_SUITE_P(
    Shared, HostileBytes,
    testing::Values(Sample{"cesiumjs-spec-tiles/Instanced/InstancedOrientation/instancedOrientation.i3dm"},
                    Sample{"cesiumjs-spec-tiles/Instanced/InstancedQuantized/instancedQuantized.i3dm"},
                    Sample{"cesiumjs-spec-tiles/Composite/Composite/composite.cmpt"},
                    Sample{"cesiumjs-spec-tiles/Batched/BatchedTextured/batchedTextured.b3dm"},
                    Sample{"3dtiles-validator-cases/tilesets/packages/validTilesetPackage.3tz"},
                    Sample{"gltf-compressed/DucksMeshopt/Duck-vp-9-vt-9-vn-9.glb", nullptr, 20},
                    Sample{"gltf-sample-models/Duck/glTF-Draco/0.bin", "gltf-sample-models/Duck/glTF-Draco/Duck.gltf"},
                    Sample{"gltf-validator-cases/ext/EXT_texture_webp/data/image/VP8_red.webp"},
                    Sample{"gltf-validator-cases/ext/EXT_texture_webp/data/image/VP8L_red_transparent.webp"},
                    Sample{"upaxis-tilesets/implicitProcessing/subtrees/0.0.0.subtree",
                           "upaxis-tilesets/implicitProcessing/tileset.json"}),
    [](const auto& sample) { return "sample_" + std::to_string(sample.index); });

}  // namespace
}  // namespace gigabake
