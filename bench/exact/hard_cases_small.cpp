#include "bench/exact/hard_cases.h"

namespace gigabake::reference {
namespace {

const std::set<Voxel> origin{{0, 0, 0}};

std::set<Voxel> one(std::int64_t x, std::int64_t y, std::int64_t z) { return {{x, y, z}}; }

std::vector<HardCase> inside_a_voxel() {
  return {
      {"inside-off-centre", {{{{10, 10, 10}, {110, 20, 30}, {30, 100, 90}}}}, origin, origin, none},
      {"inside-through-centre", {{{{40, 40, 40}, {230, 60, 128}, {110, 240, 200}}}}, origin, origin, origin},
      {"smallest-area", {{{{10, 10, 10}, {11, 10, 10}, {10, 11, 10}}}}, origin, origin, none},
      {"smallest-area-at-centre", {{{{128, 128, 128}, {129, 128, 128}, {128, 129, 128}}}}, origin, origin, origin},
      {"smallest-area-below-origin",
       {{{{-1, -1, -1}, {-2, -1, -1}, {-1, -2, -1}}}},
       one(-1, -1, -1),
       one(-1, -1, -1),
       none},
      {"thin-needle", {{{{5, 60, 70}, {250, 61, 70}, {250, 60, 70}}}}, origin, origin, none},
      {"vertex-at-corner",
       {{{{256, 256, 256}, {200, 250, 240}, {240, 200, 250}}}},
       origin,
       cells({0, 0, 0}, {1, 1, 1}),
       none},
      {"vertex-in-face",
       {{{{256, 90, 90}, {160, 100, 100}, {160, 90, 110}}}},
       origin,
       cells({0, 0, 0}, {1, 0, 0}),
       none},
      {"edge-in-face", {{{{256, 60, 60}, {256, 190, 80}, {100, 100, 100}}}}, origin, cells({0, 0, 0}, {1, 0, 0}), none},
      {"edge-on-lattice-edge",
       {{{{0, 0, 0}, {256, 0, 0}, {128, 100, 100}}}},
       origin,
       cells({-1, -1, -1}, {1, 0, 0}),
       none},
      {"edge-through-corner",
       {{{{200, 200, 200}, {312, 312, 312}, {300, 200, 230}}}},
       origin + one(1, 1, 1) + one(1, 0, 0) + one(1, 0, 1),
       cells({0, 0, 0}, {1, 1, 1}),
       none},
      {"corner-passed-by-one-sub-voxel",
       {{{{256, 256, 255}, {300, 300, 200}, {200, 300, 200}}}},
       cells({0, 1, 0}, {1, 1, 0}),
       cells({0, 0, 0}, {1, 1, 0}),
       none},
  };
}

/// Returns the same triangle in six lattice planes. Under the rules `area` and `thin`, a triangle in a lattice plane
/// belongs to the voxel above the plane.
std::vector<HardCase> in_lattice_planes() {
  const auto in_plane = [](int axis, std::int64_t at) {
    Triangle t;
    const std::int64_t uv[3][2] = {{20, 20}, {230, 30}, {40, 220}};
    for (int k = 0; k < 3; ++k) {
      t[k][axis] = at;
      t[k][(axis + 1) % 3] = uv[k][0];
      t[k][(axis + 2) % 3] = uv[k][1];
    }
    return std::vector<Triangle>{t};
  };
  return {
      {"in-plane-x-upper-face", in_plane(0, 256), one(1, 0, 0), cells({0, 0, 0}, {1, 0, 0}), one(1, 0, 0)},
      {"in-plane-y-upper-face", in_plane(1, 256), one(0, 1, 0), cells({0, 0, 0}, {0, 1, 0}), one(0, 1, 0)},
      {"in-plane-z-upper-face", in_plane(2, 256), one(0, 0, 1), cells({0, 0, 0}, {0, 0, 1}), one(0, 0, 1)},
      {"in-plane-brick-boundary", in_plane(0, 0), origin, cells({-1, 0, 0}, {0, 0, 0}), origin},
      {"in-plane-below-origin", in_plane(2, -256), one(0, 0, -1), cells({0, 0, -2}, {0, 0, -1}), one(0, 0, -1)},
      {"in-plane-window-top", in_plane(2, 2048), none, one(0, 0, 7), none},
      {"in-plane-window-bottom", in_plane(2, -2048), one(0, 0, -8), one(0, 0, -8), one(0, 0, -8)},
      {"one-sub-voxel-below-plane", in_plane(2, 255), origin, origin, origin},
      {"one-sub-voxel-above-plane", in_plane(2, 257), one(0, 0, 1), one(0, 0, 1), one(0, 0, 1)},
      {"full-face-of-two-triangles",
       {{{{0, 0, 256}, {256, 0, 256}, {256, 256, 256}}}, {{{0, 0, 256}, {256, 256, 256}, {0, 256, 256}}}},
       one(0, 0, 1),
       cells({-1, -1, 0}, {1, 1, 1}),
       one(0, 0, 1)},
  };
}

std::vector<HardCase> diagonals() {
  return {
      {"diagonal-of-cube",
       {{{{0, 0, 0}, {256, 256, 0}, {256, 256, 256}}}},
       origin,
       cells({0, 0, -1}, {1, 1, 1}) + cells({-1, -1, -1}, {0, 0, 0}),
       origin},
      {"corner-cut",
       {{{{256, 0, 0}, {0, 256, 0}, {0, 0, 256}}}},
       origin,
       cells({0, -1, -1}, {1, 0, 0}) + cells({-1, 0, -1}, {0, 1, 0}) + cells({-1, -1, 0}, {0, 0, 1}),
       origin},
      {"hexagon-through-centre",
       {{{{384, 0, 0}, {0, 384, 0}, {0, 0, 384}}}},
       origin + one(1, 0, 0) + one(0, 1, 0) + one(0, 0, 1),
       cells({-1, 0, 0}, {1, 0, 0}) + cells({0, -1, 0}, {0, 1, 0}) + cells({0, 0, -1}, {0, 0, 1}) +
           cells({1, -1, -1}, {1, 0, 0}) + cells({-1, 1, -1}, {0, 1, 0}) + cells({-1, -1, 1}, {0, 0, 1}),
       origin},
      {"diagonal-edge-neighbours",
       {{{{100, 412, 100}, {412, 100, 100}, {256, 256, 200}}}},
       one(0, 1, 0) + one(1, 0, 0),
       cells({0, 0, 0}, {1, 1, 0}),
       none},
  };
}

std::vector<HardCase> on_centre_lines() {
  return {
      {"thin-crossing-on-upper-face",
       {{{{256, 128, 128}, {160, 140, 150}, {160, 150, 200}}}},
       origin,
       cells({0, 0, 0}, {1, 0, 0}),
       one(1, 0, 0)},
      {"thin-edge-along-centre-line", {{{{20, 128, 60}, {230, 128, 60}, {120, 200, 60}}}}, origin, origin, origin},
      {"thin-edge-one-sub-voxel-past", {{{{20, 129, 60}, {230, 129, 60}, {120, 200, 60}}}}, origin, origin, none},
      {"thin-vertex-on-centre-line", {{{{128, 128, 10}, {200, 140, 20}, {200, 200, 40}}}}, origin, origin, origin},
      {"thin-wall-holds-centre-line", {{{{128, 20, 20}, {128, 240, 30}, {128, 60, 230}}}}, origin, origin, origin},
      {"thin-wall-beside-centre", {{{{128, 20, 20}, {128, 120, 20}, {128, 20, 240}}}}, origin, origin, none},
      {"thin-wall-at-45-degrees", {{{{20, 20, 20}, {240, 240, 20}, {130, 130, 240}}}}, origin, origin, origin},
      {"thin-corner-only", {{{{250, 250, 10}, {150, 250, 10}, {250, 150, 100}}}}, origin, origin, none},
      {"thin-shared-edge-on-centre",
       {{{{20, 20, 128}, {236, 236, 128}, {20, 236, 128}}}, {{{20, 20, 128}, {236, 20, 128}, {236, 236, 128}}}},
       origin,
       origin,
       origin},
  };
}

std::vector<HardCase> without_area() {
  return {
      {"point", {{{{9, 9, 9}, {9, 9, 9}, {9, 9, 9}}}}, none, none, none},
      {"two-equal-vertices", {{{{0, 0, 0}, {0, 0, 0}, {512, 512, 300}}}}, none, none, none},
      {"collinear", {{{{0, 0, 0}, {100, 200, 300}, {300, 600, 900}}}}, none, none, none},
      {"collinear-among-others",
       {{{{0, 0, 0}, {100, 200, 300}, {300, 600, 900}}}, {{{10, 10, 10}, {11, 10, 10}, {10, 11, 10}}}},
       origin,
       origin,
       none},
  };
}

}  // namespace

std::set<Voxel> cells(const Voxel& low, const Voxel& high) {
  std::set<Voxel> out;
  for (std::int64_t z = low[2]; z <= high[2]; ++z)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t x = low[0]; x <= high[0]; ++x) out.insert({x, y, z});
  return out;
}

std::set<Voxel> operator+(std::set<Voxel> a, const std::set<Voxel>& b) {
  a.insert(b.begin(), b.end());
  return a;
}

std::vector<HardCase> small_hard_cases() {
  std::vector<HardCase> all;
  for (const auto& group : {inside_a_voxel(), in_lattice_planes(), diagonals(), on_centre_lines(), without_area()})
    all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace gigabake::reference
