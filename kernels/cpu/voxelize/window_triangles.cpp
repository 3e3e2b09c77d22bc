#include "kernels/cpu/voxelize/window_triangles.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/classify_triangle.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/window.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t triangles_per_window_range = 16384;

/// The triangles [begin, end) of a part. Bit i of `kept` is set if triangle begin + i is kept.
struct Range {
  std::uint32_t part;
  std::size_t begin, end;
  std::vector<std::uint64_t> kept = {};
  std::size_t kept_count = 0;
  TriangleCounts<std::uint64_t> counts{};
};

UnsetArray<SnappedVertex> snap_vertices(const PartArrays& part, std::size_t vertices, const CellWindow& window, int lod,
                                        const ThreadPool& pool) {
  UnsetArray<SnappedVertex> out(vertices);
  pool.parallel_for(out.size(), 65536, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t i = begin; i < end; ++i) out[i] = snap_vertex(window, part, std::uint32_t(i), lod);
  });
  return out;
}

/// A part with its vertices snapped to the lattice.
struct SnappedPart {
  PartArrays part;
  int lod;             ///< level at which its triangles are voxelized
  const float* id_uv;  ///< coordinates of ids that classes are taken from; null if there are none
  UnsetArray<SnappedVertex> vertices;

  WindowTriangle triangle(std::uint32_t number, std::uint32_t index, std::uint32_t v[3]) const {
    WindowTriangle t{{}, number, index};
    triangle_vertices(part, index, v);
    for (int i = 0; i < 3; ++i) t.p[i] = vertices[v[i]];
    return t;
  }
  bool has_bad_id_uv(const std::uint32_t v[3]) const {
    float uv[6];
    return id_uv != nullptr && !load_uv(id_uv, v, uv);
  }
};

void judge(const SnappedPart& from, const CellWindow& window, Range& range) {
  range.kept.assign((range.end - range.begin + 63) / 64, 0);
  for (std::size_t t = range.begin; t < range.end; ++t) {
    std::uint32_t v[3];
    const WindowTriangle triangle = from.triangle(range.part, std::uint32_t(t), v);
    const TriangleClass triangle_class = classify_triangle(window, from.part, v, triangle.p, from.lod);
    ++range.counts.triangle_class[int(triangle_class)];
    range.counts.bad_uv +=
        has_bad_uv(triangle_class, from.part, v) || (triangle_class == TriangleClass::kept && from.has_bad_id_uv(v));
    const std::size_t bit = t - range.begin;
    range.kept[bit / 64] |= std::uint64_t(triangle_class == TriangleClass::kept) << bit % 64;
    range.kept_count += triangle_class == TriangleClass::kept;
  }
}

void collect(const SnappedPart& from, const Range& range, WindowTriangle* to) {
  std::uint32_t v[3];
  for (std::size_t word = 0; word < range.kept.size(); ++word)
    for (std::uint64_t rest = range.kept[word]; rest != 0; rest &= rest - 1)
      *to++ = from.triangle(range.part, std::uint32_t(range.begin + 64 * word + unsigned(std::countr_zero(rest))), v);
}

}  // namespace

UnsetArray<WindowTriangle> window_triangles(const CellInput& input, const CellParameters& parameters,
                                            const ThreadPool& pool, CellStats& stats) {
  const CellWindow window = window_of(parameters);
  std::vector<SnappedPart> parts;
  std::vector<Range> ranges;
  for (std::uint32_t p = 0; p < input.parts.size; ++p) {
    const PartView& view = input.parts[p];
    const PartArrays part = part_arrays(input, view);
    const float* id_uv = parameters.classes && view.id_texture != nullptr ? view.id_uv.data : nullptr;
    parts.push_back({part, view.lod, id_uv, snap_vertices(part, view.position.size / 3, window, view.lod, pool)});
    const std::size_t count = view.index.size / 3;
    for (std::size_t begin = 0; begin < count; begin += triangles_per_window_range)
      ranges.push_back({p, begin, std::min(count, begin + triangles_per_window_range)});
  }
  pool.parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) judge(parts[ranges[r].part], window, ranges[r]);
  });
  std::vector<std::size_t> first{0};
  for (const Range& range : ranges) {
    first.push_back(first.back() + range.kept_count);
    add_to(stats, range.counts);
  }
  UnsetArray<WindowTriangle> all(first.back());
  pool.parallel_for(ranges.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t r = begin; r < end; ++r) collect(parts[ranges[r].part], ranges[r], all.data() + first[r]);
  });
  return all;
}

}  // namespace gigabake::kernels
