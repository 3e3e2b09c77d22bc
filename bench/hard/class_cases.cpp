#include "bench/hard/hard_case.h"

namespace gigabake::bench {
namespace {

using reference::Triangle;
using reference::Voxel;

struct ClassTriangles {
  VoxelClass voxel_class = no_class;
  std::vector<Triangle> triangles;
};

/// Returns a rectangle at height `z` as two triangles, in sub-voxels.
ClassTriangles rectangle(VoxelClass voxel_class, std::int64_t x0, std::int64_t x1, std::int64_t y1, std::int64_t z) {
  return {voxel_class, {{{{x0, 0, z}, {x1, 0, z}, {x1, y1, z}}}, {{{x0, 0, z}, {x1, y1, z}, {x0, y1, z}}}}};
}
ClassTriangles half(VoxelClass voxel_class, int number) {
  return rectangle(voxel_class, 128 * number, 128 * number + 128, 256, 40 + 60 * number);
}
ClassTriangles quarter(VoxelClass voxel_class, int number) {
  return rectangle(voxel_class, 64 * number, 64 * number + 64, 256, 40 + 20 * number);
}

/// Returns a figure with the number of voxels that have another class than derived by hand.
HardFigure class_figure(const StoredVoxels& stored, const std::map<Voxel, VoxelClass>& by_hand) {
  double other = 0;
  for (const auto& [at, voxel_class] : by_hand) {
    const auto found = stored.find(at);
    other += found == stored.end() || found->second.voxel_class != voxel_class;
  }
  return {"another class", "voxels", other, 0};
}

HardCase class_case(const char* name, const char* what, const std::vector<ClassTriangles>& parts,
                    const std::map<Voxel, VoxelClass>& by_hand, SurfaceRule rule = SurfaceRule::area) {
  HardCase hard = lattice_case(name, "classes", what);
  hard.parameters.surface = rule;
  hard.scenes[0].tiles.clear();
  for (const ClassTriangles& part : parts) {
    HardTile tile;
    tile.voxel_class = part.voxel_class;
    for (const Triangle& t : part.triangles) add_triangle(tile, t, lattice_unit_m);
    hard.scenes[0].tiles.push_back(std::move(tile));
  }
  hard.more = [by_hand](const HardBake& bake) { return std::vector{class_figure(bake.voxels, by_hand)}; };
  return hard;
}

std::vector<HardCase> ties() {
  const std::int64_t edge = 256;
  const ClassTriangles below{8, {{{{0, 0, 100}, {edge, 0, 100}, {edge, edge, 100}}}}},
      above{6, {{{{0, 0, 100}, {edge, edge, 100}, {0, edge, 100}}}}},
      left{5, {{{{edge, 0, 0}, {edge, edge, 0}, {edge, 0, edge}}}}},
      right{4, {{{{edge, edge, 0}, {edge, edge, edge}, {edge, 0, edge}}}}};
  return {
      class_case("class-tie", "two halves of a voxel: the lower class wins", {half(3, 0), half(5, 1)},
                 {{{0, 0, 0}, 3}}),
      class_case("class-tie-reversed", "the order of the sources has no influence", {half(5, 0), half(3, 1)},
                 {{{0, 0, 0}, 3}}),
      class_case("class-tie-with-none", "content without a class counts as class 0, the lowest",
                 {half(7, 0), half(no_class, 1)}, {{{0, 0, 0}, no_class}}),
      class_case("class-tie-of-the-highest", "the highest ids of 16 bits", {half(65535, 0), half(65534, 1)},
                 {{{0, 0, 0}, 65534}}),
      class_case("class-tie-of-three", "three quarters of a voxel", {quarter(9, 0), quarter(4, 1), quarter(6, 2)},
                 {{{0, 0, 0}, 4}}),
      class_case("class-tie-of-sums", "two quarters have the area of a half",
                 {half(2, 0), quarter(1, 2), quarter(1, 3)}, {{{0, 0, 0}, 1}}),
      class_case("class-tie-on-a-diagonal", "two triangles of a square", {below, above}, {{{0, 0, 0}, 6}}),
      class_case("class-tie-in-a-lattice-plane", "two triangles between two voxels occupy the upper one", {left, right},
                 {{{1, 0, 0}, 4}}),
  };
}

std::vector<HardCase> decisions() {
  const Triangle touching{{{256, 90, 90}, {160, 100, 100}, {160, 90, 110}}},
      beyond{{{300, 20, 20}, {500, 30, 20}, {400, 230, 20}}};
  return {
      class_case("class-larger-by-a-strip", "1/512 voxel² decides",
                 {half(3, 0), half(9, 1), rectangle(9, 0, 128, 1, 30)}, {{{0, 0, 0}, 9}}),
      class_case("class-of-parts", "areas of a class add up over its triangles",
                 {half(1, 0), quarter(2, 2), quarter(2, 3), rectangle(2, 0, 64, 8, 90)}, {{{0, 0, 0}, 2}}),
      class_case("class-touch-loses-against-area", "a touch occupies a voxel, but has hardly a weight",
                 {{1, {touching}}, {2, {beyond}}}, {{{0, 0, 0}, 1}, {{1, 0, 0}, 2}}, SurfaceRule::conservative),
  };
}

/// Returns a tie in a leaf of level 1: two halves at twice the size.
HardCase tie_in_a_leaf() {
  std::vector<ClassTriangles> parts{half(5, 0), half(3, 1)};
  std::vector<reference::Painted> surface;
  for (ClassTriangles& part : parts)
    for (Triangle& t : part.triangles) {
      surface.push_back({t, reference::white16, AlphaMode::opaque, {}});
      t = {t[0] * 2, t[1] * 2, t[2] * 2};
    }
  HardCase hard = class_case("class-tie-in-a-leaf", "two halves of a leaf of level 1", parts, {});
  for (HardTile& tile : hard.scenes[0].tiles) tile.lod = 1;
  hard.expected_levels = [surface] {
    return std::vector<ExpectedVoxels>{{}, reference::expected_voxels(surface, SurfaceRule::area, {{-4, -4, -4}, 8})};
  };
  hard.more = [](const HardBake& bake) { return std::vector{class_figure(bake.leaves.at(0), {{{0, 0, 0}, 3}})}; };
  return hard;
}

}  // namespace

std::vector<HardCase> class_cases() {
  std::vector<HardCase> out = ties();
  for (HardCase& hard : decisions()) out.push_back(std::move(hard));
  out.push_back(tie_in_a_leaf());
  return out;
}

}  // namespace gigabake::bench
