#include "kernels/cpu/window_triangles.h"

#include <algorithm>

#include "kernels/body/part.h"
#include "kernels/body/triangle_fate.h"
#include "kernels/body/window.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t triangles_per_range = 16384;

struct RangeResult {
  std::vector<WindowTriangle> triangles;
  TriangleCounts<std::uint64_t> counts{};
};

std::vector<SnappedVertex> snap_vertices(const PartArrays& part, std::size_t vertices, const CellWindow& window,
                                         const ThreadPool& pool) {
  std::vector<SnappedVertex> out(vertices);
  pool.parallel_for(out.size(), 65536, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) out[i] = snap_vertex(window, part, std::uint32_t(i));
  });
  return out;
}

/// Triangle t.index of part t.part.
void add_triangle(const PartArrays& part, const std::vector<SnappedVertex>& vertices, const CellWindow& window,
                  WindowTriangle t, RangeResult& out) {
  std::uint32_t v[3];
  triangle_vertices(part, t.index, v);
  for (int i = 0; i < 3; ++i) std::copy_n(vertices[v[i]].v, 3, t.p[i]);
  const Fate fate = fate_of(window, part, v, t.p);
  ++out.counts.fate[int(fate)];
  out.counts.bad_uv += has_bad_uv(fate, part, v);
  if (fate == Fate::kept) out.triangles.push_back(t);
}

std::vector<RangeResult> part_triangles(const CellInput& input, std::uint32_t part_index, const CellWindow& window,
                                        const ThreadPool& pool) {
  const PartView& view = input.parts[part_index];
  const PartArrays part = part_arrays(input, view);
  const std::vector<SnappedVertex> vertices = snap_vertices(part, view.position.size / 3, window, pool);
  const std::size_t count = view.index.size / 3;
  std::vector<RangeResult> ranges((count + triangles_per_range - 1) / triangles_per_range);
  pool.parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r)
      for (std::size_t t = r * triangles_per_range; t < std::min(count, (r + 1) * triangles_per_range); ++t)
        add_triangle(part, vertices, window, {{}, part_index, std::uint32_t(t)}, ranges[r]);
  });
  return ranges;
}

}  // namespace

std::vector<WindowTriangle> window_triangles(const CellInput& input, const CellParameters& parameters,
                                             const ThreadPool& pool, CellStats& stats) {
  const CellWindow window = window_of(parameters);
  std::vector<RangeResult> ranges;
  for (std::uint32_t part = 0; part < input.parts.size; ++part)
    for (RangeResult& range : part_triangles(input, part, window, pool)) ranges.push_back(std::move(range));
  std::vector<std::size_t> first{0};
  for (const RangeResult& range : ranges) {
    first.push_back(first.back() + range.triangles.size());
    add_to(stats, range.counts);
  }
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
