// The kernel bodies run on a GPU and on the CPU and return the same bits. The tests are skipped, with a message, if
// there is no GPU.
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/math/snap.h"
#include "kernels/body/mip/mip.h"
#include "kernels/body/mip/plane_fit.h"
#include "kernels/body/mip/two_level_filter.h"
#include "kernels/body/voxelize/brick_triangle.h"
#include "kernels/body/voxelize/part.h"
#include "kernels/body/voxelize/plane_offset.h"
#include "kernels/body/voxelize/surface.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/body/voxelize/vertex_normals.h"
#include "tests/kernels/cuda/same_bits.cuh"

namespace gigabake::kernels {
namespace {

using namespace test;

struct Slabs {
  std::uint64_t rule[3][8];
};

struct TouchBody {
  template <class I>
  GB_HD static void touch(const WindowTriangle& t, Slabs& out) {
    const BrickTriangle<I> b = make_brick_triangle<I>(t, {0, 0, 0});
    for (int r = 0; r < 3; ++r) touched_voxels(b, SurfaceRule(r), out.rule[r]);
  }
  GB_HD Slabs operator()(const WindowTriangle& t, const Tables&) const {
    Slabs out;
    with_integer_for(t, [&](auto integer) { touch<decltype(integer)>(t, out); });
    return out;
  }
};

TEST(DeviceBodies, TouchTheSameVoxelsAsOnTheCpu) { expect_same_bits<Slabs>(random_triangles(20000), TouchBody{}); }

struct Measured {
  std::int64_t weight[8], linear[8][3];
  std::uint16_t rgba[8][4];
  std::int16_t normal[4], offset[8];
};

/// Computes weights and shades in the voxels on the brick's diagonal.
struct MeasureBody {
  GB_HD Measured operator()(const WindowTriangle& w, const Tables& tables) const {
    const BrickTriangle<__int128> t = make_brick_triangle<__int128>(w, {0, 0, 0});
    const TrianglePlane plane = make_plane(t);
    Surface surface;
    surface.has_vertex_rgba = true;
    for (int i = 0; i < 12; ++i) surface.vertex_rgba[i / 4][i % 4] = std::uint16_t(5461 * i);
    surface.material.alpha_mode = AlphaMode::blend;
    const Vec3<std::int16_t> normal = snapped_normal(t);
    Measured out;
    out.normal[3] = 0;
    for (int c = 0; c < 3; ++c) out.normal[c] = normal[c];
    for (int i = 0; i < 8; ++i) {
      const double slab = double(i - plane.anchor[2]);
      const SlabPolygon polygon = cut_slab(plane, slab);
      const double u = double(i - plane.anchor[0]), v = double(i - plane.anchor[1]);
      const CellMoments m = moments_of(plane, polygon, u, v);
      out.weight[i] = weight_of(m.area, plane.weight_scale);
      const Rgba16 rgba =
          shade<false>(surface, plane, fragment_shape(plane, m, u, v, polygon.u, polygon.v, polygon.count), tables);
      for (int c = 0; c < 4; ++c) out.rgba[i][c] = rgba.c[c];
      out.offset[i] = offset_in(make_plane_offset(plane, normal, t.axis, slab), u, v);
      const Fragment linear =
          linear_fragment(make_linear_colour(surface, plane), u, v, m, plane.weight_scale, normal, out.offset[i]);
      for (int c = 0; c < 3; ++c) out.linear[i][c] = linear.colour[c];
    }
    return out;
  }
};

TEST(DeviceBodies, MeasureAndShadeTheSameFragmentsAsOnTheCpu) {
  expect_same_bits<Measured>(random_triangles(20000), MeasureBody{});
}

struct Normals {
  Vec3<std::int16_t> geometric, vertex[3];
};

/// Computes triangle normals and shading normals of vertices that are not on the lattice, in an instance that shears
/// and mirrors.
struct NormalBody {
  GB_HD Normals operator()(const WindowTriangle& w, const Tables&) const {
    const std::uint32_t index[3] = {0, 1, 2};
    float position[9];
    std::int16_t codes[6];
    for (int i = 0; i < 6; ++i) codes[i] = std::int16_t(w.p[i / 2][i % 2] % 16384);
    if (w.p[2][2] % 16 == 0) codes[2] = no_vertex_normal;
    for (int i = 0; i < 9; ++i) position[i] = float(w.p[i / 3][i % 3]) / 7;
    const PartArrays part{position, index, nullptr,
                          nullptr,  codes, {0.9, 0.1, -0.3, 5, 0.2, -1.1, 0.4, 6, 0.3, 0.1, 0.7, 7},
                          0,        true,  false};
    Normals out{triangle_normal(part, 0, make_brick_triangle<__int128>(w, {0, 0, 0})), {}};
    load_vertex_normals(part, 0, out.geometric, out.vertex);
    return out;
  }
};

TEST(DeviceBodies, FindTheSameNormalsAsOnTheCpu) { expect_same_bits<Normals>(random_triangles(20000), NormalBody{}); }

struct Sums {
  std::int64_t sum[sum_count];
};

std::vector<Sums> random_sums(int count) {
  std::mt19937_64 random(seed);
  std::vector<Sums> out(std::size_t(count), Sums{});
  for (Sums& s : out)
    for (int f = 0; f < 3; ++f) {
      const std::int64_t weight = std::int64_t(random() >> (28 + random() % 36)) + 1;
      std::uint16_t rgba[4];
      Vec3<std::int16_t> normal;
      for (std::uint16_t& c : rgba) c = std::uint16_t(random());
      for (std::int16_t& c : normal) c = std::int16_t(random() % 65535 - 32767);
      accumulate(s.sum, fragment_of_colour(weight, rgba, normal, std::int16_t(random() % 255 - 127)));
    }
  return out;
}

struct Resolved {
  std::uint8_t there;
  FinestVoxel voxel;
};

struct ResolveBody {
  GB_HD Resolved operator()(const Sums& s, const Tables& tables) const {
    Resolved r{0, {{{0, 0, 0, 0}, {0, 0}}, 0}};
    r.there = resolve(s.sum, tables, r.voxel) ? 1 : 0;
    return r;
  }
};

TEST(DeviceBodies, ResolveToTheSameVoxelsAsOnTheCpu) { expect_same_bits<Resolved>(random_sums(50000), ResolveBody{}); }

/// Number of raster words of a parent whose children have rasters of the edge `Edge`.
template <int Edge>
constexpr int parent_words = raster_words(Edge < max_raster_edge ? 2 * Edge : max_raster_edge);

template <int Edge>
struct Filtered {
  Voxel by_mean[2], by_view;
  std::uint16_t directional_coverage[3];  ///< 16 bits each, because padding bytes would be compared too
  std::uint32_t raster[parent_words<Edge>];
};

/// Eight voxels with their rasters; a voxel of coverage 0 does not exist.
template <int Edge>
struct FilterCase {
  Voxel child[8];
  std::uint32_t raster[8][Edge == 1 ? 1 : raster_words(Edge)];

  template <int N>
  GB_HD CellRun<N> cells(int c, int axis, int run) const {
    CellRun<N> out = {};
    for (int i = 0; i < N && child[c].rgba[3] != 0; ++i) out.word[i] = raster[c][axis * Edge * Edge / 4 + N * run + i];
    return out;
  }

  GB_HD CoverageSums see(const Tables& tables, std::uint32_t* to) const {
    if constexpr (Edge == 1) {
      AxisCoverage all;
      for (int c = 0; c < 8; ++c) all.add(c, coverage_of_finest(child[c], true, tables));
      return see_voxels(all, to);
    } else {
      return cover_children<Edge>(*this, to);
    }
  }
};

template <int Edge>
struct FilterBody {
  GB_HD Filtered<Edge> operator()(const FilterCase<Edge>& from, const Tables& tables) const {
    Filtered<Edge> out;
    const CoverageSums seen = from.see(tables, out.raster);
    std::uint32_t there[2] = {};
    for (int c = 0; c < 8; ++c) there[c / 4] |= std::uint32_t(from.child[c].rgba[3] != 0) << 8 * (c % 4);
    const Weights weights = weights_of(seen, Edge, there);
    for (int a = 0; a < 3; ++a) out.directional_coverage[a] = byte_of(weights.directional_coverage, a);
    out.by_mean[0] = filter_children<false>(from.child, {}, MipFilter::thesis, tables);
    out.by_mean[1] = filter_children<false>(from.child, {}, MipFilter::box, tables);
    out.by_view = filter_children<true>(from.child, weights, MipFilter::coverage, tables);
    return out;
  }
};

template <int Edge>
void expect_same_filter() {
  std::mt19937 random(seed);
  std::vector<FilterCase<Edge>> cases(20000);
  for (FilterCase<Edge>& f : cases) {
    for (Voxel& v : f.child) {
      for (std::uint8_t& x : v.rgba) x = std::uint8_t(random());
      if (random() % 3 == 0) v.rgba[3] = 0;
      for (std::int8_t& x : v.normal) x = std::int8_t(int(random() % 255) - 127);
    }
    f.child[random() % 8].rgba[3] = 255;
    for (auto& raster : f.raster)
      for (std::uint32_t& cells : raster) cells = std::uint32_t(random()) | 0x01010101;
  }
  expect_same_bits<Filtered<Edge>>(cases, FilterBody<Edge>{});
}

TEST(DeviceBodies, FilterTheSameLevelsAsOnTheCpu) {
  expect_same_filter<1>();
  expect_same_filter<2>();
  expect_same_filter<4>();
  expect_same_filter<8>();
}

/// Eight voxels with the moments of their surfaces; a voxel of coverage 0 does not exist.
struct PatchCase {
  Voxel child[8];
  SurfaceMoments patch[8];
  std::uint8_t plane[8];
  std::uint32_t directional_coverage;
};

struct Joined {
  SurfaceMoments patch[2];
  std::uint8_t plane[2], beside[2][3];
};

/// Joins the surface moments of children of lod 0, and of coarser lods.
struct JoinBody {
  GB_HD Joined operator()(const PatchCase& from, const Tables& tables) const {
    Weights weights{};
    weights.directional_coverage = from.directional_coverage;
    for (int c = 0; c < 8; ++c) weights.child[c / 4] |= std::uint32_t(from.child[c].rgba[3]) << 8 * (c % 4);
    Joined out;
    for (int i = 0; i < 2; ++i) {
      const auto patch = [&](int c, const UnitNormal& n) {
        return i == 0 ? finest_patch(from.plane[c], n) : from.patch[c];
      };
      const VoxelPatch made = filter_patches(from.child, patch, weights, i == 0, tables);
      const Plane plane = plane_of(made.patch, made.voxel.normal, i == 0);
      out.patch[i] = made.patch;
      out.plane[i] = pack_plane(plane);
      for (int a = 0; a < 3; ++a) out.beside[i][a] = byte_of(stored_coverage(plane, from.directional_coverage), a);
    }
    return out;
  }
};

/// Returns random cases: half of them are nearly one surface, as most voxels are; the others are arbitrary.
std::vector<PatchCase> random_patches(int count) {
  std::mt19937 random(seed);
  const auto within = [&](int reach) { return int(random() % unsigned(2 * reach + 1)) - reach; };
  std::vector<PatchCase> cases(std::size_t(count), PatchCase{});
  for (PatchCase& f : cases) {
    const bool flat = random() % 2 != 0;
    const std::int8_t normal[2] = {std::int8_t(within(127)), std::int8_t(within(127))};
    for (int c = 0; c < 8; ++c) {
      for (int a = 0; a < 2; ++a) f.child[c].normal[a] = flat ? normal[a] : std::int8_t(within(127));
      f.child[c].rgba[3] = random() % 3 == 0 ? 0 : std::uint8_t(random());
      f.plane[c] = random() % 4 == 0 ? 0 : pack_plane({within(max_offset), 1 + int(random() % 3)});
      for (std::int16_t& x : f.patch[c].place) x = std::int16_t(within(flat ? 2000 : position_unit));
      f.patch[c].spread = std::uint8_t(random() % (flat ? 40 : 256));
      f.patch[c].normal_coherence = std::uint8_t(255 - random() % (flat ? 60 : 256));
    }
    f.child[random() % 8].rgba[3] = 255;
    f.directional_coverage = std::uint32_t(random()) & 0xffffff;
  }
  return cases;
}

TEST(DeviceBodies, JoinPatchesToTheSamePlanesAsOnTheCpu) {
  expect_same_bits<Joined>(random_patches(50000), JoinBody{});
}

/// A brick of lod l - 2 with the capacity for all voxels.
struct Brick64 {
  std::uint64_t mask[8];
  Voxel voxel[brick_voxels];
};

struct Of64 {
  std::uint8_t there[8];
  Voxel voxel[8];
};

struct FilterOf64Body {
  GB_HD Of64 operator()(const Brick64& brick, const Tables& tables) const {
    Of64 out;
    for (int octant = 0; octant < 8; ++octant) {
      out.there[octant] = has_voxels(brick.mask, octant) ? 1 : 0;
      out.voxel[octant] = Voxel{};
      if (out.there[octant] == 0) continue;
      const auto voxel = [&](std::size_t i) { return brick.voxel[i]; };
      out.voxel[octant] = two_level_filter(brick.mask, octant, 0, voxel, tables);
    }
    return out;
  }
};

TEST(DeviceBodies, FilterTheSame64VoxelsAsOnTheCpu) {
  std::mt19937_64 random(seed);
  std::vector<Brick64> bricks(5000);
  for (Brick64& brick : bricks) {
    for (std::uint64_t& word : brick.mask) word = random() & (random() % 2 != 0 ? random() : random() & random());
    if (random() % 4 == 0)
      for (std::uint64_t& word : brick.mask) word &= 0xf0f0f0f;
    for (Voxel& v : brick.voxel) {
      for (std::uint8_t& x : v.rgba) x = std::uint8_t(random());
      v.rgba[3] |= 1;
      for (std::int8_t& x : v.normal) x = std::int8_t(int(random() % 255) - 127);
    }
  }
  expect_same_bits<Of64>(bricks, FilterOf64Body{});
}

struct Placed {
  float p[3];
};

struct SnapBody {
  SnapFrame frame;
  double scene_from_local[12];
  GB_HD LatticePoint operator()(const Placed& p, const Tables&) const {
    LatticePoint out{{0, 0, 0}};
    if (!snap(frame, scene_from_local, p.p, out)) out.v[0] = out.v[1] = out.v[2] = -1;
    return out;
  }
};

TEST(DeviceBodies, SnapVerticesToTheSamePointsAsOnTheCpu) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> metres(-1e5f, 1e5f);
  std::vector<Placed> points(100000);
  for (Placed& p : points)
    for (float& x : p.p) x = metres(random);
  SnapBody body{{0.0721, {0.1, -1234.56789, 3.3}},
                {0.96, -0.28, 1e-7, 1234567.8, 0.28, 0.96, 0, -4321.1, 0, 1e-9, 1.0000001, 7}};
  expect_same_bits<LatticePoint>(points, body);
}

}  // namespace
}  // namespace gigabake::kernels
