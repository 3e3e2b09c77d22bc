// Textures on fragments of triangles: a GPU and the CPU compute the same colours. The tests are skipped, with a
// message, if there is no GPU.
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <ostream>
#include <random>
#include <vector>

#include "core/base/thread_pool.h"
#include "kernels/body/voxelize/surface.h"
#include "kernels/body/voxelize/triangle_bricks.h"
#include "kernels/cpu/texture/texture.h"
#include "tests/kernels/cuda/same_bits.cuh"

namespace gigabake::kernels {
namespace {

using namespace test;

constexpr int fragments = 8;

/// The levels of a texture in device memory.
class TextureOnDevice {
 public:
  explicit TextureOnDevice(const TextureView& host) : base_(host.base, std::size_t(4) * texels(host, 0)), view_(host) {
    view_.base = base_.data();
    for (int l = 1; l < host.levels; ++l) {
      levels_.push_back(std::make_unique<DeviceArray<std::uint16_t>>(host.level[l], std::size_t(4) * texels(host, l)));
      view_.level[l] = levels_.back()->data();
    }
  }
  const TextureView& view() const { return view_; }

 private:
  static std::size_t texels(const TextureView& t, int l) {
    return std::size_t(level_extent(t.width, l)) * std::size_t(level_extent(t.height, l));
  }
  DeviceArray<std::uint8_t> base_;
  std::vector<std::unique_ptr<DeviceArray<std::uint16_t>>> levels_;
  TextureView view_;
};

struct TexturedTriangle {
  WindowTriangle triangle;
  float uv[6];
  Wrap wrap_s, wrap_t;
};

/// The intermediate results of one fragment, in order of computation, so that a failure shows the first step that
/// differs.
struct Steps {
  double area, centroid_u, centroid_v, map[6], corner[2 * Outline::maximum], image[2 * Outline::maximum];
  std::int32_t corners, level;
  std::uint16_t rgba[4];
};

struct ShadedTriangle {
  Steps of[fragments];
};

GB_HD double no_negative_zero(double x) { return x + 0.0; }

/// Processes the voxels on the brick's diagonal like kernels/cpu/voxelize/voxelize.cpp.
struct TextureBody {
  TextureView texture;
  bool nearest;

  GB_HD Steps steps(const Surface& surface, const FragmentShape& f) const {
    Steps out{};
    out.area = no_negative_zero(f.area);
    out.centroid_u = f.centroid.u;
    out.centroid_v = f.centroid.v;
    const Outline outline = outline_of(f);
    const FragmentMap map = fragment_map(nearest_map(surface.material, surface.map), texture.width, texture.height);
    TexelOutline image;
    map_outline(outline, map, {f.centroid.u - f.cell_u, f.centroid.v - f.cell_v}, image);
    const double all[6] = {map.su, map.sv, map.tu, map.tv, surface.map.s0, surface.map.t0};
    for (int i = 0; i < 6; ++i) out.map[i] = no_negative_zero(all[i]);
    out.corners = outline.count;
    for (int i = 0; i < outline.count; ++i) {
      out.corner[2 * i] = no_negative_zero(outline.at[i].u);
      out.corner[2 * i + 1] = no_negative_zero(outline.at[i].v);
      out.image[2 * i] = no_negative_zero(image.x[i]);
      out.image[2 * i + 1] = no_negative_zero(image.y[i]);
    }
    out.level = level_for(texture, image);
    return out;
  }

  GB_HD ShadedTriangle operator()(const TexturedTriangle& from, const Tables& tables) const {
    const TrianglePlane plane = make_plane(make_brick_triangle<__int128>(from.triangle, {0, 0, 0}));
    Surface surface;
    surface.texture = &texture;
    surface.material.texture = 0;
    surface.material.nearest = nearest;
    surface.material.alpha_mode = AlphaMode::blend;
    surface.material.wrap_s = from.wrap_s;
    surface.material.wrap_t = from.wrap_t;
    surface.map = make_texture_map(plane, from.uv, texture.width, texture.height);
    ShadedTriangle out{};
    for (int i = 0; i < fragments; ++i) {
      const SlabPolygon polygon = cut_slab(plane, double(i - plane.anchor[2]));
      const double u = double(i - plane.anchor[0]), v = double(i - plane.anchor[1]);
      const CellMoments m = moments_of(plane, polygon, u, v);
      if (m.area == 0) continue;
      const FragmentShape shape = fragment_shape(plane, m, u, v, polygon.u, polygon.v, polygon.count);
      out.of[i] = steps(surface, shape);
      const Rgba16 rgba = shade<false>(surface, plane, shape, tables);
      for (int c = 0; c < 4; ++c) out.of[i].rgba[c] = rgba.c[c];
    }
    return out;
  }
};

std::ostream& operator<<(std::ostream& out, const Steps& s) {
  out << std::hexfloat << "area " << s.area << ", centroid " << s.centroid_u << ' ' << s.centroid_v << ", level "
      << s.level << "\n  rgba";
  for (const std::uint16_t c : s.rgba) out << ' ' << c;
  out << "\n  map";
  for (const double x : s.map) out << ' ' << x;
  for (int i = 0; i < s.corners; ++i)
    out << "\n  corner " << s.corner[2 * i] << ' ' << s.corner[2 * i + 1] << " on the texture " << s.image[2 * i] << ' '
        << s.image[2 * i + 1];
  return out;
}

std::vector<TexturedTriangle> textured_triangles(int count) {
  std::vector<TexturedTriangle> out;
  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<float> unit(-1, 1);
  constexpr Wrap wraps[] = {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge};
  for (const WindowTriangle& t : random_triangles(count)) {
    TexturedTriangle r{t, {}, wraps[random() % 3], wraps[random() % 3]};
    const float reach = std::ldexp(1.0f, int(random() % 14) - 6), s = 3 * unit(random), at = 3 * unit(random);
    for (int i = 0; i < 6; ++i) r.uv[i] = (i % 2 == 0 ? s : at) + reach * unit(random);
    out.push_back(r);
  }
  return out;
}

void expect_same_colours(bool nearest, int width, int height, TextureAlpha alpha) {
  if (!has_device()) GTEST_SKIP() << "no CUDA device";
  std::mt19937 random(seed);
  std::vector<std::uint8_t> texels(std::size_t(4 * width * height));
  for (std::uint8_t& x : texels) x = std::uint8_t(random());
  const Texture texture(std::move(texels), width, height, alpha, 128, ThreadPool(1));
  const TextureOnDevice there(texture.view());
  const std::vector<TexturedTriangle> in = textured_triangles(60000);
  const auto from_device = run_on_device<ShadedTriangle>(in, TextureBody{there.view(), nearest});
  const TextureBody here{texture.view(), nearest};
  const Tables tables = TableStore::host().view();
  int others = 0, all = 0;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const ShadedTriangle expected = here(in[i], tables);
    for (int f = 0; f < fragments; ++f) {
      const Steps &e = expected.of[f], &d = from_device[i].of[f];
      all += e.area != 0;
      if (std::memcmp(&e, &d, sizeof e) == 0) continue;
      if (++others <= 3)
        ADD_FAILURE() << "triangle " << i << ", cell " << f << ", wraps " << int(in[i].wrap_s) << ' '
                      << int(in[i].wrap_t) << "\nhost " << e << "\ndevice " << d;
    }
  }
  EXPECT_EQ(others, 0) << "of " << all << " fragments; " << width << " x " << height << ", seed " << seed;
  EXPECT_GT(all, 10000);
}

TEST(DeviceTextures, OfTheNearestTexelAreTheSameAsOnTheCpu) {
  expect_same_colours(true, 37, 5, TextureAlpha::blend);
  expect_same_colours(true, 64, 64, TextureAlpha::mask);
  expect_same_colours(true, 1024, 512, TextureAlpha::ignore);
}

TEST(DeviceTextures, OfInterpolatedTexelsAreTheSameAsOnTheCpu) {
  expect_same_colours(false, 37, 5, TextureAlpha::blend);
  expect_same_colours(false, 64, 64, TextureAlpha::mask);
  expect_same_colours(false, 1024, 512, TextureAlpha::ignore);
}

}  // namespace
}  // namespace gigabake::kernels
