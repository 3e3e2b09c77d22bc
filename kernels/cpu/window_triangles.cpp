#include "kernels/cpu/window_triangles.h"

#include <algorithm>

#include "kernels/body/surface.h"
#include "lattice/brick.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

/// A vertex relative to the window, or why it has none.
struct WindowVertex {
  std::int64_t v[3];
  bool valid;
};

constexpr std::size_t triangles_per_range = 16384;

struct RangeResult {
  std::vector<WindowTriangle> triangles;
  CellStats stats;
};

std::vector<WindowVertex> snap_vertices(const PartView& part, const CellParameters& parameters,
                                        const ThreadPool& pool) {
  std::vector<WindowVertex> out(part.position.size / 3);
  pool.parallel_for(out.size(), 65536, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) {
      LatticePoint p;
      out[i].valid = snap(parameters.frame, part.scene_from_local, part.position.data + 3 * i, p);
      for (int c = 0; c < 3; ++c) out[i].v[c] = out[i].valid ? p.v[c] - parameters.window_min[c] * subvoxels : 0;
    }
  });
  return out;
}

bool has_area(const WindowVertex& a, const WindowVertex& b, const WindowVertex& c) {
  using Wide = __int128;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    if (Wide(b.v[i] - a.v[i]) * (c.v[j] - a.v[j]) != Wide(b.v[j] - a.v[j]) * (c.v[i] - a.v[i])) return true;
  }
  return false;
}

/// Closed test: every surface rule's voxels lie within.
bool meets_window(const WindowVertex& a, const WindowVertex& b, const WindowVertex& c, std::int64_t window_subvoxels) {
  for (int k = 0; k < 3; ++k) {
    if (std::min({a.v[k], b.v[k], c.v[k]}) > window_subvoxels) return false;
    if (std::max({a.v[k], b.v[k], c.v[k]}) < 0) return false;
  }
  return true;
}

bool is_oversized(const WindowVertex& p) {
  return std::any_of(p.v, p.v + 3, [](std::int64_t x) { return x > widest_coordinate || x < -widest_coordinate; });
}

void add_triangle(const WindowVertex* const p[3], std::uint32_t part, std::uint32_t index,
                  std::int64_t window_subvoxels, RangeResult& out) {
  if (!p[0]->valid || !p[1]->valid || !p[2]->valid) {
    ++out.stats.non_finite;
    return;
  }
  if (!meets_window(*p[0], *p[1], *p[2], window_subvoxels)) return;
  if (!has_area(*p[0], *p[1], *p[2])) {
    ++out.stats.zero_area;
    return;
  }
  if (is_oversized(*p[0]) || is_oversized(*p[1]) || is_oversized(*p[2])) {
    ++out.stats.oversized;
    return;
  }
  WindowTriangle t;
  for (int i = 0; i < 3; ++i)
    for (int c = 0; c < 3; ++c) t.p[i][c] = std::int32_t(p[i]->v[c]);
  t.part = part;
  t.index = index;
  out.triangles.push_back(t);
}

bool has_bad_uv(const PartView& part, const std::uint32_t v[3]) {
  float uv[6];
  for (int i = 0; i < 6; ++i) uv[i] = part.uv[2 * std::size_t(v[i / 2]) + i % 2];
  return !usable_uv(uv);
}

std::vector<RangeResult> part_triangles(const CellInput& input, std::uint32_t part_index,
                                        const CellParameters& parameters, const ThreadPool& pool) {
  const PartView& part = input.parts[part_index];
  const bool textured = is_textured(input, part);
  const bool mirrored = is_mirrored(part.scene_from_local);
  const std::vector<WindowVertex> vertices = snap_vertices(part, parameters, pool);
  const std::size_t count = part.index.size / 3;
  std::vector<RangeResult> ranges((count + triangles_per_range - 1) / triangles_per_range);
  pool.parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t t = r * triangles_per_range; t < std::min(count, (r + 1) * triangles_per_range); ++t) {
        std::uint32_t v[3];
        triangle_vertices(part, mirrored, std::uint32_t(t), v);
        const WindowVertex* const p[3] = {&vertices[v[0]], &vertices[v[1]], &vertices[v[2]]};
        const std::size_t before = ranges[r].triangles.size();
        add_triangle(p, part_index, std::uint32_t(t), std::int64_t(parameters.window_voxels) * subvoxels, ranges[r]);
        if (textured && ranges[r].triangles.size() != before && has_bad_uv(part, v)) ++ranges[r].stats.bad_uv;
      }
  });
  return ranges;
}

}  // namespace

bool is_textured(const CellInput& input, const PartView& part) {
  return input.materials[part.material].texture >= 0 && !part.uv.empty();
}

bool is_mirrored(const double m[12]) {
  return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
             m[2] * (m[4] * m[9] - m[5] * m[8]) <
         0;
}

std::vector<WindowTriangle> window_triangles(const CellInput& input, const CellParameters& parameters,
                                             const ThreadPool& pool, CellStats& stats) {
  std::vector<RangeResult> ranges;
  for (std::uint32_t part = 0; part < input.parts.size; ++part)
    for (RangeResult& range : part_triangles(input, part, parameters, pool)) ranges.push_back(std::move(range));
  std::vector<std::size_t> first{0};
  for (const RangeResult& range : ranges) {
    first.push_back(first.back() + range.triangles.size());
    stats.non_finite += range.stats.non_finite;
    stats.zero_area += range.stats.zero_area;
    stats.oversized += range.stats.oversized;
    stats.bad_uv += range.stats.bad_uv;
  }
  stats.triangles = first.back();
  std::vector<WindowTriangle> all(first.back());
  pool.parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) {
      std::copy(ranges[r].triangles.begin(), ranges[r].triangles.end(), all.begin() + std::ptrdiff_t(first[r]));
      ranges[r] = {};
    }
  });
  return all;
}

}  // namespace gigabake::kernels
