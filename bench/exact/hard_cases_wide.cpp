#include "bench/exact/hard_cases.h"

namespace gigabake::reference {
namespace {

constexpr std::int64_t far = 500'000 * 256;  ///< triangles below are a million voxels wide
constexpr std::int64_t low = hard_case_low, last = hard_case_high - 1;

template <class Predicate>
std::set<Voxel> where(const Predicate& holds) {
  std::set<Voxel> out;
  for (const Voxel& v : cells({low, low, low}, {last, last, last}))
    if (holds(v[0], v[1], v[2])) out.insert(v);
  return out;
}

const std::set<Voxel> layer = cells({low, low, 0}, {last, last, 0});

/// Returns a square of two triangles that extends beyond the window. It lies in the plane z = a·x + b·y + c.
std::vector<Triangle> sheet(std::int64_t reach, std::int64_t a, std::int64_t b, std::int64_t c) {
  const auto at = [&](std::int64_t x, std::int64_t y) { return LatticeVertex{x, y, a * x + b * y + c}; };
  return {{at(-reach, -reach), at(reach, -reach), at(reach, reach)},
          {at(-reach, -reach), at(reach, reach), at(-reach, reach)}};
}

/// Returns the mesh with rotated axes: its z becomes x.
std::vector<Triangle> turned(std::vector<Triangle> mesh) {
  for (Triangle& t : mesh)
    for (LatticeVertex& v : t) v = {v[2], v[0], v[1]};
  return mesh;
}

std::vector<HardCase> sheets() {
  const auto steps = [](std::int64_t first, std::int64_t end) {
    return where([=](auto i, auto j, auto k) { return i + j + k >= first && i + j + k <= end; });
  };
  const auto apart = [](std::int64_t first, std::int64_t end) {
    return where([=](auto i, auto j, auto) { return i - j >= first && i - j <= end; });
  };
  return {
      {"million-wide-flat", sheet(far, 0, 0, 100), layer, layer, layer},
      {"million-wide-in-lattice-plane", sheet(far, 0, 0, 0), layer, cells({low, low, -1}, {last, last, 0}), layer},
      {"million-wide-above-plane-by-one", sheet(far, 0, 0, 1), layer, layer, layer},
      {"million-wide-below-plane-by-one", sheet(far, 0, 0, -1), cells({low, low, -1}, {last, last, -1}),
       cells({low, low, -1}, {last, last, -1}), cells({low, low, -1}, {last, last, -1})},
      {"million-wide-through-all-corners", sheet(far, -1, -1, 0), steps(-2, -1), steps(-3, 0), steps(-1, -1)},
      {"million-wide-through-centres", sheet(far, -1, -1, 384), steps(-1, 1), steps(-1, 1), steps(0, 0)},
      {"million-wide-45-degrees-on-edges", turned(sheet(far, 1, 0, 0)), apart(0, 0), apart(-1, 1), apart(0, 0)},
      {"million-wide-45-degrees-on-centres", turned(sheet(far, 1, 0, 128)), apart(0, 1), apart(0, 1), apart(0, 1)},
      {"million-wide-one-sub-voxel-off-corners", sheet(far, -1, -1, 1), steps(-2, 0), steps(-2, 0), steps(-1, -1)},
  };
}

std::vector<HardCase> wide_edges() {
  const auto half_plane_area = where([](auto i, auto j, auto k) { return j == k && i >= j; });
  const auto half_plane_closed = where([](auto i, auto j, auto k) {
    const auto upper = j > k ? j : k, lower = j > k ? k : j;
    return upper - lower <= 1 && i + 1 >= upper;
  });
  return {
      {"million-long-edge-through-corners",
       {{{{-far, -far, -far}, {far, far, far}, {far, 0, 0}}}},
       half_plane_area,
       half_plane_closed,
       half_plane_area},
      {"million-long-sliver",
       {{{{-far, 100, 100}, {far, 100, 100}, {far, 101, 100}}}},
       cells({low, 0, 0}, {last, 0, 0}),
       cells({low, 0, 0}, {last, 0, 0}),
       none},
      {"million-long-sliver-on-lattice-line",
       {{{{-far, 0, 0}, {far, 0, 0}, {far, 1, 0}}}},
       cells({low, 0, 0}, {last, 0, 0}),
       cells({low, -1, -1}, {last, 0, 0}),
       none},
      {"million-long-sliver-under-lattice-line",
       {{{{-far, 0, 0}, {far, -1, 0}, {far, 0, 0}}}},
       cells({low, -1, 0}, {last, -1, 0}),
       cells({low, -1, -1}, {last, 0, 0}),
       none},
      {"million-long-diagonal-sliver",
       {{{{-far, -far, -far}, {far, far, far}, {far, far, far + 1}}}},
       where([](auto i, auto j, auto k) { return i == j && (k == i || k == i + 1); }),
       where([](auto i, auto j, auto k) {
         const auto in = [](auto d) { return d >= -1 && d <= 1; };
         return in(i - j) && in(j - k) && in(k - i);
       }),
       where([](auto i, auto j, auto k) { return i == j && j == k; })},
      {"million-wide-misses-window", sheet(far, 0, 0, 3000), none, none, none},
      {"million-wide-box-overlaps-window-plane-misses",
       {{{{far, -far, -far}, {-far, far, -far}, {-far, -far, far}}}},
       none,
       none,
       none},
  };
}

std::vector<HardCase> slivers() {
  return {
      {"row-sliver",
       {{{{10, 10, 10}, {1800, 11, 10}, {1800, 10, 11}}}},
       cells({0, 0, 0}, {7, 0, 0}),
       cells({0, 0, 0}, {7, 0, 0}),
       none},
      {"sliver-on-lattice-line",
       {{{{0, 0, 0}, {1792, 0, 0}, {1792, 1, 0}}}},
       cells({0, 0, 0}, {6, 0, 0}),
       cells({-1, -1, -1}, {7, 0, 0}),
       none},
      {"sliver-under-lattice-line",
       {{{{0, 0, 0}, {1792, -1, 0}, {1792, 0, 0}}}},
       cells({0, -1, 0}, {6, -1, 0}),
       cells({-1, -1, -1}, {7, 0, 0}),
       none},
      {"sliver-along-centre-lines",
       {{{{0, 128, 128}, {1792, 128, 128}, {1792, 129, 128}}}},
       cells({0, 0, 0}, {6, 0, 0}),
       cells({-1, 0, 0}, {7, 0, 0}),
       cells({0, 0, 0}, {6, 0, 0})},
  };
}

}  // namespace

std::vector<HardCase> wide_hard_cases() {
  std::vector<HardCase> all;
  for (const auto& group : {sheets(), wide_edges(), slivers()}) all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace gigabake::reference
