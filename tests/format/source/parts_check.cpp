#include "parts_check.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>

#include "core/base/error.h"

namespace gigabake::test {
namespace {

/// Returns the expected part: `triangles` triangles of the whole list from `first` on, with only the vertices they use.
Primitive expected_part(const Primitive& whole, std::size_t first, std::size_t triangles) {
  Primitive out;
  const std::vector<std::uint32_t> corners(whole.index.begin() + std::ptrdiff_t(3 * first),
                                           whole.index.begin() + std::ptrdiff_t(3 * (first + triangles)));
  std::vector<std::uint32_t> used = corners;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<std::uint32_t> place(whole.position.size() / 3);
  const auto take = [](const auto& from, std::size_t v, std::size_t width, auto& to) {
    if (!from.empty()) to.insert(to.end(), &from[v * width], &from[v * width] + width);
  };
  for (const std::uint32_t v : used) {
    place[v] = std::uint32_t(out.position.size() / 3);
    take(whole.position, v, 3, out.position);
    take(whole.uv, v, 2, out.uv);
    take(whole.rgba, v, 4, out.rgba);
    take(whole.normal_uv, v, 2, out.normal_uv);
    take(whole.tangent, v, 1, out.tangent);
    take(whole.normal, v, 1, out.normal);
  }
  for (const std::uint32_t c : corners) out.index.push_back(place[c]);
  return out;
}

/// Compares bit by bit, because a value may be NaN.
template <class T>
bool is_same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const Primitive& got, const Primitive& expected, const std::string& what) {
  EXPECT_TRUE(is_same(got.index, expected.index)) << what;
  EXPECT_TRUE(is_same(got.position, expected.position)) << what;
  EXPECT_TRUE(is_same(got.uv, expected.uv)) << what;
  EXPECT_TRUE(is_same(got.rgba, expected.rgba)) << what;
  EXPECT_TRUE(is_same(got.normal_uv, expected.normal_uv)) << what;
  EXPECT_TRUE(is_same(got.tangent, expected.tangent)) << what;
  EXPECT_TRUE(is_same(got.normal, expected.normal)) << what;
}

struct Streamed {
  TileMesh mesh;
  std::vector<Primitive> parts;
  std::string error;
};

/// Reads the tile whole, or its parts with three threads.
Streamed read(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, bool in_parts) {
  Streamed out;
  const PrimitiveSink sink = [&](std::size_t index, Primitive&& primitive) {
    EXPECT_EQ(index, out.parts.size());
    EXPECT_LE(primitive.index.size() / 3, max_part_triangles);
    out.parts.push_back(std::move(primitive));
  };
  try {
    static const ThreadPool pool(3);
    out.mesh = read_tile(tile, root, scope, in_parts ? sink : nullptr, pool);
  } catch (const InputError& e) {
    out.error = e.what();
  }
  return out;
}

void expect_same_placements(const TileMesh& whole, const TileMesh& parts, const std::vector<int>& first,
                            const std::vector<int>& count) {
  std::size_t at = 0;
  for (const Instance& instance : whole.instances)
    for (int k = 0; k < count[std::size_t(instance.primitive)]; ++k, ++at) {
      ASSERT_LT(at, parts.instances.size());
      EXPECT_EQ(parts.instances[at].primitive, first[std::size_t(instance.primitive)] + k);
      EXPECT_EQ(parts.instances[at].scene_from_local.m, instance.scene_from_local.m);
    }
  EXPECT_EQ(at, parts.instances.size());
}

std::size_t parts_of(const Primitive& whole) {
  const std::size_t triangles = whole.index.size() / 3;
  return std::max<std::size_t>(1, (triangles + max_part_triangles - 1) / max_part_triangles);
}

void expect_same(const TileMesh& whole, const Streamed& streamed) {
  std::vector<int> first, count;
  std::size_t at = 0;
  for (const Primitive& w : whole.primitives) {
    const std::size_t triangles = w.index.size() / 3, vertices = w.position.size() / 3, parts = parts_of(w);
    first.push_back(int(at)), count.push_back(int(parts));
    for (std::size_t k = 0; k < parts; ++k, ++at) {
      ASSERT_LT(at, streamed.parts.size());
      const std::string what = "part " + std::to_string(at);
      const std::size_t begin = k * max_part_triangles, end = std::min(begin + max_part_triangles, triangles);
      const bool is_whole = triangles <= max_part_triangles && vertices <= 3 * max_part_triangles;
      expect_same(streamed.parts[at], is_whole ? w : expected_part(w, begin, end - begin), what);
      for (const Primitive& p : {std::cref(streamed.parts[at]), std::cref(streamed.mesh.primitives.at(at))}) {
        EXPECT_EQ(p.material, w.material) << what;
        EXPECT_EQ(p.position_step, w.position_step) << what;
      }
      EXPECT_TRUE(streamed.mesh.primitives[at].position.empty() && streamed.mesh.primitives[at].index.empty()) << what;
    }
  }
  EXPECT_EQ(at, streamed.parts.size());
  EXPECT_EQ(at, streamed.mesh.primitives.size());
  expect_same_placements(whole, streamed.mesh, first, count);
}

}  // namespace

std::size_t expect_same_in_parts(const TileRef& tile, const std::filesystem::path& root) {
  std::size_t parts = 0;
  for (const ReadScope scope : {ReadScope::positions_only, ReadScope::everything}) {
    const Streamed whole = read(tile, root, scope, false), streamed = read(tile, root, scope, true);
    EXPECT_EQ(streamed.error, whole.error) << tile.name;
    if (!whole.error.empty() || !streamed.error.empty()) continue;
    EXPECT_EQ(streamed.mesh.counts.triangles, whole.mesh.counts.triangles) << tile.name;
    EXPECT_EQ(streamed.mesh.counts.skipped_points, whole.mesh.counts.skipped_points) << tile.name;
    EXPECT_EQ(streamed.mesh.counts.skipped_lines, whole.mesh.counts.skipped_lines) << tile.name;
    EXPECT_EQ(streamed.mesh.warnings, whole.mesh.warnings) << tile.name;
    EXPECT_EQ(streamed.mesh.materials.size(), whole.mesh.materials.size()) << tile.name;
    EXPECT_EQ(streamed.mesh.images.size(), whole.mesh.images.size()) << tile.name;
    expect_same(whole.mesh, streamed);
    parts = streamed.parts.size();
  }
  return parts;
}

}  // namespace gigabake::test
