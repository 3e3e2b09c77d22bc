#include "core/base/memory_limit.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

#include "core/base/error.h"
#include "format/source/image/image_size.h"
#include "format/source/image/png_bytes.h"
#include "format/source/source.h"

// 2026-11-22: --memory limited neither images nor instances nor JSON.
namespace gigabake {
namespace {

using Path = std::filesystem::path;

/// The process's memory limit during the lifetime of this object.
struct Limit {
  explicit Limit(std::uint64_t bytes) { set_memory_limit(bytes); }
  ~Limit() { set_memory_limit(0); }
};

template <class Work>
std::string refusal(const Work& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

void expect_memory_line(const std::string& line) {
  for (const char* part : {"bytes), `memory_bytes` allows ", "raise it"})
    EXPECT_NE(line.find(part), std::string::npos) << "no '" << part << "' in: " << line;
}

class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("memory-limit-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Path file(const char* name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  Path path_;
};

TEST(MemoryClaim, SaysHowMuchIsWantedAndAllowedAndWhatRaisesIt) {
  const Limit limit(1 << 20);
  MemoryClaim claim("a.glb");
  claim.add_items(1024, 1024, "nodes", "nodes");
  EXPECT_EQ(
      refusal([&] { claim.add_items(3, 1, "nodes", "placements"); }),
      "a.glb: nodes: 3 placements would take 1.0 MB of memory (1048579 bytes), `memory_bytes` allows 1.0 MB (1048576 "
      "bytes); raise it, or split the file");
}

TEST(MemoryClaim, DoesNotWrapAround) {
  const Limit limit(1 << 20);
  constexpr std::uint64_t maximum = std::numeric_limits<std::uint64_t>::max();
  EXPECT_NE(refusal([] { MemoryClaim("a").add_items(maximum / 2, 4, "", "x"); }), "");
  EXPECT_NE(refusal([] {
              MemoryClaim claim("a");
              claim.add(1 << 20, "", "x");
              claim.add(maximum, "", "x");
            }),
            "");
}

/// Returns the reason why a source with this text is refused, without the folder's name.
std::string line_of_json(const std::string& text) {
  const Folder folder;
  const Path file = folder.file("t.json", text);
  const std::string line = refusal([&] { open_sources(file, {}); });
  return line.substr(std::min(line.size(), line.find("t.json")));
}

TEST(ParsedJson, IsRefusedBeforeItsValuesTakeMoreThanIsAllowed) {
  std::string text = "{\"gigabake\":[";
  for (int i = 0; i < 300'000; ++i) text += "[],";
  text += "0]}";
  EXPECT_EQ(line_of_json(text).find("memory"), std::string::npos);
  const Limit limit(16 << 20);
  expect_memory_line(line_of_json(text));
}

TEST(ParsedJson, SaysLineByteAndWhatWasExpectedInItsOwnWords) {
  EXPECT_EQ(line_of_json("{\n\"a\": 1,\n\"b\" 2}"), "t.json: not valid JSON in line 3: expected ':' (at byte 15)");
  EXPECT_EQ(line_of_json("[1e999]"), "t.json: not valid JSON: a number that is too large (at byte 6)");
  for (const std::string& text : {std::string("{\"a\": " + std::string(1'000'000, '7') + "x"), std::string("[1,"),
                                  std::string("\"\xff\""), std::string("nul"), std::string("")}) {
    const std::string line = line_of_json(text);
    EXPECT_NE(line, "");
    EXPECT_LE(line.size(), max_message_bytes);
    EXPECT_EQ(line.find("exception"), std::string::npos) << line;
    EXPECT_EQ(line.find("777777"), std::string::npos) << line;
  }
}

TEST(TilesOfATileset, AreReadAsAStream) {
  constexpr int tiles = 10'000;
  std::string text = R"({"asset":{"version":"1.0"},"root":{"refine":"ADD","boundingVolume":{"sphere":[0,0,0,9]},)"
                     R"("transform":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1],"children":[)";
  for (int i = 0; i < tiles; ++i)
    text += std::string(i == 0 ? "" : ",") +
            R"({"geometricError":1,"boundingVolume":{"box":[0,0,0,9,0,0,0,9,0,0,0,9]},"content":{"uri":"a.glb"},)"
            R"("extras":{"a":[1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20]}})";
  const Folder folder;
  folder.file("a.glb", "glTF");
  const Path file = folder.file("t.json", text + "]}}");
  const Limit limit(12 << 20);  // half of the memory that all JSON values would take
  const SceneSources sources = open_sources(file, {});
  EXPECT_EQ(sources.tiles.size(), std::size_t(tiles));
  EXPECT_EQ(sources.tiles.back().scene_from_tile.m[2][3], 7);
}

/// Returns the names of the missing files in the order in which they were found missing: children before their parent.
std::string missing_in(const std::string& root) {
  const Folder folder;
  const Path file = folder.file("t.json", R"({"asset":{"version":"1.0"},)" + root + "}");
  std::string names;
  for (const SkippedSource& lost : open_sources(file, {}).skipped) names += lost.reason.substr(1, 1);
  return names;
}

TEST(TilesOfATileset, KeepOrderAndDepth) {
  EXPECT_EQ(missing_in(R"("root":{"refine":"ADD","children":[{"children":[{"content":{"uri":"a"}},)"
                       R"({"content":{"uri":"b"}}],"content":{"uri":"c"}},{"content":{"uri":"d"},"children":[)"
                       R"({"content":{"uri":"e"}}]}],"content":{"uri":"f"}})"),
            "abcedf");
}

TEST(TilesOfATileset, AreThoseOfTheLastOfTwoMembersOfOneName) {
  EXPECT_EQ(missing_in(R"("root":{"content":{"uri":"x"}},"root":{"children":[{"content":{"uri":"a"}},)"
                       R"({"content":{"uri":"b"}}],"children":[{"content":{"uri":"c"}}]})"),
            "c");
}

TEST(TilesOfATileset, AreNamedWhereTheyAreMalformed) {
  const auto line_of = [](const std::string& root) {
    return line_of_json(R"({"asset":{"version":"1.0"},)" + root + "}");
  };
  const Folder folder;
  const Path file =
      folder.file("t.json", R"({"asset":{"version":"1.0"},"root":{"children":[{},{"children":[{"refine":"MUL"}]}]}})");
  const std::vector<SkippedSource> lost = open_sources(file, {}).skipped;
  ASSERT_EQ(lost.size(), 1u);  // 2026-11-25: only the malformed tile is missing, not the tileset
  EXPECT_EQ(lost[0].name, "t.json: root.children[1].children[0]");
  EXPECT_TRUE(lost[0].reason.ends_with("refine: expected ADD or REPLACE, got 'MUL'")) << lost[0].reason;
  const Path other = folder.file("u.json", R"({"asset":{"version":"1.0"},"root":{"children":[7]}})");
  const std::vector<SkippedSource> no_tile = open_sources(other, {}).skipped;
  ASSERT_EQ(no_tile.size(), 1u);  // 2026-11-25: only the entry that is no tile is missing
  EXPECT_EQ(no_tile[0].name, "u.json: root.children");
  EXPECT_EQ(no_tile[0].reason, "expected tiles, which are JSON objects");
  EXPECT_EQ(line_of(R"("root":[])"), "t.json: root: expected a JSON object");
}

TEST(DecodedImage, IsRefusedByItsHeaderWhereItWouldNotFit) {
  const std::vector<std::uint8_t> texels(std::size_t(4) * 1024 * 1024, 9);
  const EncodedImage image{"p.png", png_bytes("p.png", 1024, 1024, texels)};
  EXPECT_EQ(decode_image(image).width, 1024);
  EXPECT_EQ(image_size(image).texture_bytes(), std::uint64_t(7) << 20);
  const Limit limit(6 << 20);
  expect_memory_line(refusal([&] { decode_image(image); }));
}

std::string read_line(const Path& file) {
  return refusal([&] {
    const SceneSources sources = open_sources(file, {});
    for (const TileRef& tile : sources.tiles) read_tile(tile, sources.root, ReadScope::everything);
  });
}

TEST(Placements, AreCountedBeforeTheyTakeMemory) {
  const Folder folder;
  const std::string instanced = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,"nodes":[{"mesh":0,)"
                                R"("extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}}],)"
                                R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[)"
                                R"({"componentType":5126,"count":3,"type":"VEC3"},)"
                                R"({"componentType":5126,"count":1000000,"type":"VEC3"}]})";
  const Path file = folder.file("a.gltf", instanced);
  const Limit limit(128 << 20);
  expect_memory_line(read_line(file));
}

TEST(Placements, OfVerticesFromNowhereAreCountedToo) {
  const Folder folder;
  std::string text = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,"nodes":[{"mesh":0}],)"
                     R"("accessors":[{"componentType":5126,"count":999999,"type":"VEC3"}],"meshes":[{"primitives":[)";
  for (int i = 0; i < 20; ++i) text += std::string(i == 0 ? "" : ",") + R"({"attributes":{"POSITION":0}})";
  const Path file = folder.file("a.gltf", text + "]}]}");
  const Limit limit(256 << 20);
  expect_memory_line(read_line(file));
}

TEST(WholeFile, IsNotReadWhereItWouldNotFit) {
  const Folder folder;
  const Path file = folder.file("a.gltf", "{}");
  std::filesystem::resize_file(file, 2 << 20);
  const Limit limit(1 << 20);
  expect_memory_line(read_line(file));
}

}  // namespace
}  // namespace gigabake
