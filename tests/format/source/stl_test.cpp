// STL meshes, written here by hand.
#include <cstring>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "format/source/source.h"
#include "mesh_file.h"
#include "source_scene.h"

namespace gigabake {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Stl : public test::MeshFile {
 protected:
  Stl() : MeshFile("a.stl") {}
  /// Returns a binary STL with a facet per nine numbers; the normals are invalid.
  static std::string binary(const std::string& name, const std::vector<std::array<float, 9>>& facets) {
    std::string out = name + std::string(80 - name.size(), '\0');
    const auto count = std::uint32_t(facets.size());
    out.append(reinterpret_cast<const char*>(&count), 4);
    for (const auto& f : facets) {
      const float normal[3] = {7, 8, 9};
      out.append(reinterpret_cast<const char*>(normal), sizeof normal);
      out.append(reinterpret_cast<const char*>(f.data()), sizeof f);
      out.append("\x12\x34", 2);
    }
    return out;
  }
  const std::array<float, 9> facet{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::string loop = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n";
  const std::string end = "  endloop\n endfacet\n";
};

TEST_F(Stl, ReadsText) {
  const TileMesh mesh = read("solid a name of my own\n" + loop + end + "endsolid a\nsolid b\n" + loop +
                             "   VERTEX -1 5e-1 0\n" + end + "endsolid b\n");
  EXPECT_EQ(mesh.counts.triangles, 3u);
  EXPECT_THAT(mesh.primitives.at(0).index, testing::SizeIs(9));
  EXPECT_EQ(mesh.primitives[0].position.size(), 21u);
  EXPECT_EQ(mesh.primitives[0].position[19], 0.5f);
  EXPECT_EQ(mesh.instances.at(0).scene_from_local({0, 1, 0}), (Point<Scene>{0, 0, 1})) << "y is up";
}

// 2026-11-25: the whole file and all its vertices as doubles were kept in memory.
TEST_F(Stl, ComesInPartsThatAreSmallWhereMemoryIsSmall) {
  std::vector<std::array<float, 9>> facets(40000, facet);
  for (std::size_t i = 0; i < facets.size(); ++i) facets[i][0] = 20000 + float(i);
  const TileMesh whole = read(binary("many", facets));
  for (const std::uint64_t limit : {std::uint64_t(0), std::uint64_t(1) << 24}) {
    set_memory_limit(limit);
    std::vector<float> position;
    std::size_t parts = 0;
    const TileMesh mesh = read_parts([&](std::size_t, Primitive&& part) {
      ++parts;
      for (const std::uint32_t v : part.index)
        position.insert(position.end(), &part.position[3 * v], &part.position[3 * v] + 3);
    });
    set_memory_limit(0);
    EXPECT_EQ(parts, limit == 0 ? 1u : 3u);
    EXPECT_EQ(mesh.counts.triangles, facets.size());
    EXPECT_EQ(mesh.primitives.at(0).position_step, whole.primitives.at(0).position_step);
    EXPECT_EQ(mesh.instances.at(0).scene_from_local({0, 0, 0}), whole.instances.at(0).scene_from_local({0, 0, 0}));
    EXPECT_TRUE(position == whole.primitives[0].position);
  }
}

TEST_F(Stl, ReadsBinaryThatBeginsWithSolidToo) {
  for (const char* name : {"exported by something", "solid by something", "solid"}) {
    const TileMesh mesh = read(binary(name, {facet, {0, 0, 0, 0, 0, 2, 0, 2, 0}}));
    EXPECT_EQ(mesh.counts.triangles, 2u) << name;
    EXPECT_THAT(mesh.primitives.at(0).index, ElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_EQ(mesh.primitives[0].position[14], 2);
  }
  EXPECT_EQ(read(binary("trailing bytes", {facet}) + "more").counts.triangles, 1u);
}

TEST_F(Stl, KnowsHowCoarseFloatsFarAwayAre) {
  const TileMesh mesh = read(binary("far", {{5412000, 0, 0, 5412001, 0, 0, 5412000, 1, 0}}));
  EXPECT_EQ(mesh.primitives.at(0).position_step, 0.5f);
  EXPECT_EQ(mesh.instances.at(0).scene_from_local({0, 0, 0}).x, 5412001) << "the middle in whole metres";
}

TEST_F(Stl, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(refusal(""), HasSubstr("ends inside the header of a binary STL (at byte 0)"));
  EXPECT_THAT(
      refusal(binary("cut", {facet, facet}).substr(0, 150)),
      HasSubstr(
          "expected 2 triangles as the header states, the file holds 1; it is cut short, or not an STL (at byte 80)"));
  EXPECT_THAT(refusal(std::string(80, 'x') + "\xff\xff\xff\xff"), HasSubstr("expected 4294967295 triangles"));
  EXPECT_THAT(refusal("solid a\n" + loop + end), HasSubstr("expected \"endsolid\""));
  EXPECT_THAT(refusal("solid a\n" + loop), HasSubstr("expected \"endsolid\""));
}

std::vector<std::string> stl_lines_of(const TileMesh& mesh) {
  std::vector<std::string> lines;
  for (const SourceWarning& w : mesh.warnings) lines.push_back((w.is_loss ? "loss: " : "") + w.line());
  return lines;
}

// 2026-11-25: a file was refused because of one bad number.
TEST_F(Stl, LeavesOutOneBadFacet) {
  const std::string bad = "outer loop\nvertex 1 2 x\nvertex 1 0 0\nvertex 0 1 0\nendloop\n";
  const TileMesh mesh =
      read("\xEF\xBB\xBFsolid a\r\n" + bad + loop + end + "outer loop\nvertex 1 2 3\nendloop\nflavour 7\nendsolid\n");
  EXPECT_EQ(mesh.counts.triangles, 2u);
  EXPECT_THAT(
      stl_lines_of(mesh),
      ElementsAre("loss: vertices without three coordinates, whose facets are left out: 1, e.g. line 3",
                  HasSubstr("loss: facets of fewer than three corners: 1"), HasSubstr("lines not understood: 1")));
}

// 2026-11-25: facets beyond the header's count were dropped without a message.
TEST_F(Stl, SaysThatTheCountContradictsTheSize) {
  const auto with_count = [&](std::uint32_t count) {
    std::string bytes = binary("count", {facet, facet});
    std::memcpy(&bytes[80], &count, sizeof count);
    for (std::size_t facet_end : {134, 184}) bytes.replace(facet_end - 2, 2, 2, '\0');
    return bytes;
  };
  for (const std::uint32_t fewer : {0u, 1u}) {
    const TileMesh mesh = read(with_count(fewer));
    EXPECT_EQ(mesh.counts.triangles, 2u);
    EXPECT_THAT(stl_lines_of(mesh), ElementsAre(HasSubstr("the header states fewer triangles than the file holds")));
  }
  const TileMesh more = read(with_count(7));
  EXPECT_EQ(more.counts.triangles, 2u);
  EXPECT_THAT(stl_lines_of(more), ElementsAre(HasSubstr("loss: the header states more triangles")));
  EXPECT_THAT(stl_lines_of(read(with_count(2) + "more")), ElementsAre(HasSubstr("e.g. 4 bytes")));
  EXPECT_TRUE(stl_lines_of(read(with_count(2))).empty());
  EXPECT_THAT(stl_lines_of(read(binary("attributes", {facet}))), ElementsAre(HasSubstr("triangles with attributes")));
}

// 2026-11-25: one far facet moved the origin, so that all other facets snapped to steps of 0.25 m.
TEST_F(Stl, KeepsItsPrecisionWithOneFarFacet) {
  const TileMesh mesh = read(
      "solid a\nouter loop\nvertex 500000.123 5200000 0\nvertex 500001 5200000 0\nvertex 500000 "
      "5200001 0\nendloop\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendsolid\n");
  ASSERT_EQ(mesh.primitives.size(), 2u);
  EXPECT_EQ(mesh.instances[0].scene_from_local({0, 0, 0}).x, 0);
  const float* p = mesh.primitives[1].position.data();
  EXPECT_NEAR(mesh.instances[1].scene_from_local({p[0], p[1], p[2]}).x, 500000.123, 1e-6);
}

}  // namespace
}  // namespace gigabake
