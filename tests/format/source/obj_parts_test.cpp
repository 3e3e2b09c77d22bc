// Large OBJ files: text is read in blocks, and triangles are passed on in parts.
#include <array>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <random>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/mesh_parts.h"
#include "format/source/source.h"
#include "format/source/tile_hash.h"
#include "source_scene.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t line_vertices = 1000;

/// Returns vertices with colours and texture coordinates, then alternating faces of materials `a` and `b`, fewer of
/// `b`. Corners of `b` have no texture coordinates; some faces of `a` are quadrilaterals.
std::string large_text() {
  std::mt19937 random(1);
  std::string out = "mtllib gone.mtl\n";
  for (std::uint32_t v = 0; v < line_vertices; ++v) {
    const auto number = [&random] { return " " + std::to_string(double(random()) / 4e9); };
    out += "v" + number() + number() + number() + " 0.5 0.25" + number() + "\nvt" + number() + number() + "\nvn" +
           number() + number() + number() + "\n";
  }
  const auto corner = [&random] { return std::to_string(random() % line_vertices + 1); };
  for (std::uint64_t turn = 0; turn < 1300; ++turn) {
    out += "usemtl a\n";
    for (int f = 0; f < 1000; ++f) {
      for (const char* between : {"f ", " ", " "}) {
        const std::string v = corner();
        out += between + v + "/" + v + "/" + v;
      }
      out += f % 100 == 0 ? " -3/-7\n" : "\n";
    }
    out += "usemtl b\n";
    for (int f = 0; f < 650; ++f) out += "f " + corner() + " " + corner() + " " + corner() + "\n";
  }
  return out;
}

class ObjParts : public testing::Test {
 protected:
  ~ObjParts() override { set_memory_limit(0); }
  void open(const std::string& text) { sources = open_sources(file = folder.write("a.obj", text), {}); }
  TileMesh read(const PrimitiveSink& sink = nullptr) const {
    return read_tile(sources.tiles.at(0), sources.root, ReadScope::everything, sink);
  }
  std::string refusal(const PrimitiveSink& sink = nullptr) const {
    try {
      read(sink);
    } catch (const InputError& e) {
      return e.what();
    }
    return "was read";
  }
  test::SourceFolder folder;
  std::filesystem::path file;
  SceneSources sources;
};

/// The values of all corners of a material's triangles, in order.
struct CornerValues {
  std::vector<float> position, uv;
  std::vector<std::uint16_t> rgba;
  std::vector<VertexNormal> normal;
  friend bool operator==(const CornerValues&, const CornerValues&) = default;

  void add(const Primitive& p) {
    const auto take = [&p](const auto& from, std::size_t width, auto& to) {
      if (from.empty()) return;
      for (const std::uint32_t v : p.index) to.insert(to.end(), &from.at(v * width), &from[v * width] + width);
    };
    take(p.position, 3, position), take(p.uv, 2, uv), take(p.rgba, 4, rgba), take(p.normal, 1, normal);
  }
};

TEST_F(ObjParts, HoldTheTrianglesOfTheWhole) {
  open(large_text());
  std::map<int, CornerValues> of_whole, of_parts;
  const TileMesh whole = read();
  for (const Primitive& p : whole.primitives) of_whole[p.material].add(p);
  std::vector<int> materials;
  const TileMesh parts = read([&](std::size_t index, Primitive&& p) {
    EXPECT_EQ(index, materials.size());
    EXPECT_LE(p.index.size() / 3, max_part_triangles);
    EXPECT_LE(p.position.size() / 3, 3 * line_vertices);
    materials.push_back(p.material);
    of_parts[p.material].add(p);
  });
  ASSERT_EQ(whole.primitives.size(), 2u);
  EXPECT_GT(materials.size(), 2u);
  EXPECT_TRUE(of_whole == of_parts);
  EXPECT_FALSE(of_whole.at(0).uv.empty() || !of_whole.at(1).uv.empty() || of_whole.at(1).rgba.empty());
  EXPECT_FALSE(of_whole.at(0).normal.empty());
  EXPECT_EQ(parts.counts.triangles, whole.counts.triangles);
  EXPECT_EQ(parts.warnings, whole.warnings);
  EXPECT_EQ(parts.materials.size(), whole.materials.size());
  ASSERT_EQ(parts.primitives.size(), materials.size());
  ASSERT_EQ(parts.instances.size(), materials.size());
  for (std::size_t i = 0; i < materials.size(); ++i) {
    EXPECT_EQ(parts.primitives[i].material, materials[i]);
    EXPECT_TRUE(parts.primitives[i].position.empty());
    EXPECT_EQ(parts.instances[i].primitive, int(i));
    EXPECT_EQ(parts.instances[i].scene_from_local.m, whole.instances[0].scene_from_local.m);
  }
}

TEST_F(ObjParts, LoseOneFaceAsTheWholeDoes) {
  open(large_text() + "usemtl a\nf 1 2 1001\n");
  const TileMesh whole = read(), parts = read([](std::size_t, Primitive&&) {});
  EXPECT_EQ(parts.warnings, whole.warnings);
  EXPECT_EQ(parts.counts.triangles, whole.counts.triangles);
  EXPECT_TRUE(std::any_of(whole.warnings.begin(), whole.warnings.end(),
                          [](const SourceWarning& w) { return w.is_loss && w.count == 1; }));
}

/// The second reading of the file finds a material that the first did not find.
TEST_F(ObjParts, AFileThatChangesMeanwhileIsOneLine) {
  open(large_text() + "usemtl a\nf 1/1 2/1 3/1\n");
  const auto size = std::filesystem::file_size(file);
  EXPECT_THAT(refusal([&](std::size_t, Primitive&&) {
                std::fstream out(file, std::ios::in | std::ios::out | std::ios::binary);
                out.seekp(std::streamoff(size - 16));
                out << 'z';
              }),
              HasSubstr("changed while it was read; bake again"));
  open(large_text());
  EXPECT_THAT(refusal([&](std::size_t, Primitive&&) { std::filesystem::resize_file(file, 10'000); }),
              HasSubstr("a.obj: became shorter while it was read"));
}

TEST_F(ObjParts, AreClaimedAndTheTextIsNot) {
  open(large_text() + "#" + std::string(std::size_t(60) << 20, '-'));
  set_memory_limit(std::uint64_t(40) << 20);
  tile_hash(sources.tiles.at(0), sources.root);
  EXPECT_EQ(refusal([](std::size_t, Primitive&&) {}), "was read");
  // 2026-11-25: with a limit of 8 MiB the file was refused. A small limit makes parts smaller.
  set_memory_limit(std::uint64_t(8) << 20);
  EXPECT_EQ(refusal([](std::size_t, Primitive&&) {}), "was read");
  set_memory_limit(std::uint64_t(256) << 10);
  EXPECT_THAT(refusal([](std::size_t, Primitive&&) {}), HasSubstr("corners of triangles would take"));
}

struct Seen {
  std::size_t number;
  std::string word, rest;
  friend bool operator==(const Seen&, const Seen&) = default;
};

template <class Text>
std::vector<Seen> lines_of(const Text& text) {
  std::vector<Seen> out;
  for_each_obj_line("a.obj", text, [&](const ObjLine& l) {
    out.push_back({l.number, std::string(l.word), std::string(l.rest)});
  });
  return out;
}

/// Blocks may end anywhere: in a word, before a line's end, behind a backslash.
TEST(ObjLines, AreTheSameInBlocksAsInOnePiece) {
  const test::RandomSeed seed;
  std::mt19937_64 random(seed);
  const std::string letters = "av#\\ \r\n\n\n\t12";
  std::vector<std::uint8_t> text(3 * read_block_bytes + random() % 100);
  for (std::uint8_t& c : text) c = std::uint8_t(letters[random() % letters.size()]);
  for (std::size_t block = 1; block <= 3; ++block) text[block * read_block_bytes - 1] = block == 2 ? '\n' : '\\';
  const std::vector<Seen> expected = lines_of(std::span<const std::uint8_t>(text));
  EXPECT_GT(expected.size(), 1000u);
  EXPECT_TRUE(lines_of(SourceBytes(text)) == expected);
}

TEST(ObjLines, WithoutAnEndAreRefused) {
  const SourceBytes text(std::vector<std::uint8_t>((std::size_t(1) << 26) + 1, 'v'));
  try {
    lines_of(text);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("a.obj: line 1: is longer than 64 MiB"));
  }
}

}  // namespace
}  // namespace gigabake
