// Gzip-compressed tiles, tilesets and subtrees under their usual names, as servers store them.
#include "format/source/content/gzip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <zlib.h>

#include "core/base/error.h"
#include "format/source/source.h"
#include "format/source/source_files.h"
#include "format/source/tile_hash.h"
#include "tests/format/source/source_scene.h"

namespace gigabake {
namespace {

using test::Json;
using test::SourceFolder;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

std::string gzipped(const std::string& text) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = uInt(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = uInt(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

std::string error_of(const std::string& packed, std::uint64_t max_bytes = 1 << 20) {
  try {
    unpacked_gzip("tile.b3dm", bytes_of(packed), max_bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::string b3dm_of(const std::string& model) {
  std::string out = "b3dm";
  const std::uint32_t words[] = {1, std::uint32_t(28 + model.size()), 0, 0, 0, 0};
  return out.append(reinterpret_cast<const char*>(words), sizeof words) + model;
}

/// Writes an external tileset, an implicit one with its subtree, a b3dm and a glTF; `packed` compresses each file.
void write_set(const SourceFolder& folder, std::string (*packed)(const std::string&)) {
  Json implicit = test::tile("tile.b3dm");
  implicit["implicitTiling"] = {{"subdivisionScheme", "QUADTREE"},
                                {"subtreeLevels", 2},
                                {"availableLevels", 2},
                                {"subtrees", {{"uri", "all.subtree"}}}};
  Json root = test::tile("", {test::tile("nested.json"), implicit});
  root["refine"] = "ADD";
  folder.write("tileset.json", packed(test::tileset(root).dump()));
  folder.write("nested.json", packed(test::tileset(test::tile("square.gltf")).dump()));
  folder.write("square.gltf", packed(test::square_gltf().dump()));
  folder.write("tile.b3dm", packed(b3dm_of(test::square_gltf().dump())));
  const Json all{{"constant", 1}}, none{{"constant", 0}};
  const Json subtree{
      {"tileAvailability", all}, {"contentAvailability", Json::array({all})}, {"childSubtreeAvailability", none}};
  folder.write("all.subtree", packed(subtree.dump()));
}

TEST(Gzip, ASetOfPackedFilesIsTheSetThatTheyUnpackTo) {
  const SourceFolder plain, packed;
  write_set(plain, [](const std::string& text) { return text; });
  write_set(packed, gzipped);
  const SceneSources a = open_sources(plain.path() / "tileset.json", {});
  const SceneSources b = open_sources(packed.path() / "tileset.json", {});
  EXPECT_TRUE(b.skipped.empty());
  ASSERT_EQ(a.tiles.size(), 6u);
  ASSERT_EQ(b.tiles.size(), 6u);
  for (std::size_t i = 0; i < a.tiles.size(); ++i) {
    EXPECT_EQ(tile_hash(a.tiles[i], a.root), tile_hash(b.tiles[i], b.root));
    EXPECT_EQ(read_tile(b.tiles[i], b.root, ReadScope::everything).counts.triangles, 2u);
  }
}

TEST(Gzip, ABufferIsUnpackedWhereItIsAGzipFileToItsEndAndElseTakenAsItIs) {
  Json model = test::square_gltf();
  model["buffers"][0]["uri"] = "square.bin";
  const SourceFolder folder;
  const float corners[] = {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1};
  const std::uint16_t indices[] = {0, 2, 1, 0, 3, 2};
  std::string raw(reinterpret_cast<const char*>(corners), sizeof corners);
  raw.append(reinterpret_cast<const char*>(indices), sizeof indices);
  folder.write("square.bin", gzipped(raw));
  const auto tile = folder.write("square.gltf", model.dump());
  const SceneSources sources = open_sources(tile, {});
  EXPECT_EQ(read_tile(sources.tiles.at(0), sources.root, ReadScope::everything).counts.triangles, 2u);

  const std::string alike = std::string("\x1f\x8b\x08", 3) + raw.substr(3);
  folder.write("square.bin", alike);
  EXPECT_EQ(SourceFiles(folder.path()).read_referenced(folder.path() / "square.bin"), bytes_of(alike));
}

TEST(Gzip, UnpacksWhatWasPackedWhateverItsSize) {
  std::mt19937_64 rng(7);
  for (const std::size_t size : {0, 1, 65535, 65536, 65537, 1 << 20}) {
    std::string text(size, '\0');
    for (char& c : text) c = char(rng() % 5);
    EXPECT_EQ(unpacked_gzip("f", bytes_of(gzipped(text)), 1 << 20), bytes_of(text)) << size;
    EXPECT_EQ(unpacked_gzip_head(bytes_of(gzipped(text)), 4), bytes_of(text.substr(0, 4))) << size;
  }
}

TEST(Gzip, ContentThatIsCutDamagedOrFollowedByMoreIsOneClearLine) {
  const std::string whole = gzipped(std::string(5000, 'x') + "y");
  EXPECT_EQ(error_of(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(error_of(whole.substr(0, size)), HasSubstr("gzip ends early or is damaged (at byte ")) << size;
  std::string damaged = whole;
  damaged[damaged.size() - 6] ^= 1;  // the checksum
  EXPECT_THAT(error_of(damaged), HasSubstr("gzip ends early or is damaged"));
  EXPECT_THAT(error_of(whole + whole), HasSubstr("bytes follow where the gzip content ends"));
  EXPECT_THAT(error_of(gzipped(std::string((1 << 20) + 1, '\0'))), HasSubstr("unpacks to more than 1048576 bytes"));
}

TEST(Gzip, ADamagedTileIsRefusedByName) {
  const SourceFolder folder;
  const auto tile = folder.write("tile.b3dm", gzipped(b3dm_of(test::square_gltf().dump())).substr(0, 100));
  const SceneSources sources = open_sources(tile, {});
  try {
    read_tile(sources.tiles.at(0), sources.root, ReadScope::everything);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("tile.b3dm: gzip ends early or is damaged"));
  }
}

}  // namespace
}  // namespace gigabake
