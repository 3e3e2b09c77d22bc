#include "cuda_scenes.h"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "core/base/host_device.h"
#include "core/base/rules.h"
#include "core/base/thread_pool.h"

namespace gigabake::kernels::test {
namespace {

constexpr double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

float ground_height(double x, double y, double window) {
  return float(window * (0.5 + 0.2 * std::sin(7 * x / window) * std::cos(9 * y / window)) + 0.7 * std::sin(x + 2 * y));
}

MaterialView material(AlphaMode alpha, std::int32_t texture, Wrap wrap) {
  MaterialView m;
  m.base_rgba[0] = 60000;
  m.base_rgba[1] = 40000;
  m.base_rgba[3] = 50000;
  m.alpha_mode = alpha;
  m.texture = texture;
  m.wrap_s = m.wrap_t = wrap;
  return m;
}

/// Adds a shifted copy of the ground for each combination of alpha mode and texture wrapping.
void add_textured_sheets(TestCell& cell, std::initializer_list<AlphaMode> modes) {
  TestCell from = ground("", 64, 10, true, false);
  const CellInput other = from.input();
  const PartView& p = other.parts[0];
  const std::vector<float> position(p.position.data, p.position.data + p.position.size),
      uv(p.uv.data, p.uv.data + p.uv.size);
  const std::vector<std::uint32_t> index(p.index.data, p.index.data + p.index.size);
  int n = 0;
  for (const AlphaMode alpha : modes)
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge}) {
      const TextureAlpha use = alpha == AlphaMode::opaque ? TextureAlpha::ignore
                               : alpha == AlphaMode::mask ? TextureAlpha::mask
                                                          : TextureAlpha::blend;
      cell.materials.push_back(material(alpha, cell.add_texture(7 + 31 * n, 64, use, unsigned(n) + 2), wrap));
      cell.materials.back().nearest = n % 2 == 1;
      std::vector<float> moved = position;
      for (std::size_t i = 2; i < moved.size(); i += 3) moved[i] += float(3 * n - 12);
      cell.add_part(std::move(moved), index, std::uint32_t(cell.materials.size() - 1), uv);
      ++n;
    }
}

}  // namespace

void TestCell::add_part(std::vector<float> position, std::vector<std::uint32_t> index, std::uint32_t material,
                        std::vector<float> uv, std::vector<std::uint16_t> rgba) {
  PartView p;
  const auto floats = [this](std::vector<float> v) {
    floats_.push_back(std::move(v));
    return Span<const float>{floats_.back().data(), floats_.back().size()};
  };
  p.position = floats(std::move(position));
  p.uv = floats(std::move(uv));
  indices_.push_back(std::move(index));
  p.index = {indices_.back().data(), indices_.back().size()};
  colours_.push_back(std::move(rgba));
  p.rgba = {colours_.back().data(), colours_.back().size()};
  for (int i = 0; i < 12; ++i) p.scene_from_local[i] = identity[i];
  p.material = material;
  parts_.push_back(p);
}

void TestCell::add_vertex_normals(unsigned seed) {
  name += " with vertex normals";
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (PartView& p : parts_) {
    std::vector<VertexNormal> normal;
    for (std::size_t v = 0; v < p.position.size / 3; ++v) {
      const double x = unit(random), y = unit(random), z = unit(random), some = v % 17 == 0 ? 0 : 1;
      normal.push_back(encode_vertex_normal({x * some, y * some, (2 + z) * some * (v % 50 < 25 ? 1 : -1)}));
    }
    normals_.push_back(std::move(normal));
    p.normal = {normals_.back().data(), normals_.back().size()};
  }
}

void TestCell::add_normal_maps(unsigned seed) {
  name += " with normal maps";
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  int n = 0;
  for (PartView& p : parts_) {
    const int width = 5 + 13 * n, height = n % 3 == 0 ? 8 : 40;
    p.normal_map.texture =
        add_texture(width, height, TextureAlpha::ignore, seed + unsigned(n), TextureContent::directions);
    p.normal_map.scale = n % 4 == 3 ? -0.5f : float(1 + n % 2);
    p.normal_map.wrap_s = Wrap(n % 3);
    p.normal_map.wrap_t = Wrap(n / 3 % 3);
    p.normal_map.nearest = n % 5 == 4;
    std::vector<float> uv;
    std::vector<VertexTangent> tangent;
    for (std::size_t v = 0; v < p.position.size / 3; ++v) {
      uv.push_back(v % 97 == 96 ? std::numeric_limits<float>::quiet_NaN() : float(3 * unit(random)));
      uv.push_back(float(unit(random)));
      const double some = v % 13 == 12 ? 0 : 1, x = unit(random), y = unit(random), z = unit(random);
      tangent.push_back(encode_vertex_tangent({(2 + x) * some, y * some, z * some}, v % 100 < 50));
    }
    floats_.push_back(std::move(uv));
    p.normal_uv = n % 3 == 2 && !p.uv.empty() ? p.uv : Span<const float>{floats_.back().data(), floats_.back().size()};
    tangents_.push_back(std::move(tangent));
    if (n % 2 == 0) p.tangent = {tangents_.back().data(), tangents_.back().size()};
    ++n;
  }
}

void TestCell::add_instance(double x, double y, double z, double scale) {
  PartView p = parts_.back();
  const double m[12] = {scale, 0, 0, x, 0, std::fabs(scale), 0, y, 0, 0, std::fabs(scale), z};
  for (int i = 0; i < 12; ++i) p.scene_from_local[i] = m[i];
  parts_.push_back(p);
}

std::int32_t TestCell::add_texture(int width, int height, TextureAlpha alpha, unsigned seed, TextureContent content) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> rgba(std::size_t(4) * std::size_t(width) * std::size_t(height));
  for (auto& x : rgba) x = std::uint8_t(random());
  textures_.emplace_back(std::move(rgba), width, height, alpha, std::uint8_t(128), ThreadPool(1), content);
  return std::int32_t(textures_.size()) - 1;
}

CellInput TestCell::input() {
  views_.clear();
  for (const Texture& t : textures_) views_.push_back(t.view());
  return {{parts_.data(), parts_.size()}, {materials.data(), materials.size()}, {views_.data(), views_.size()}};
}

CellParameters TestCell::parameters(SurfaceRule surface, MipFilter mip, bool normals) const {
  CellParameters p;
  p.window_voxels = window_voxels;
  p.surface = surface;
  p.mip = mip;
  p.normals = normals;
  return p;
}

TestCell ground(std::string name, std::uint32_t window_voxels, int quads, bool uv, bool rgba) {
  TestCell cell;
  cell.name = std::move(name);
  cell.window_voxels = window_voxels;
  cell.materials.push_back({});
  std::vector<float> position, coordinates;
  std::vector<std::uint32_t> index;
  std::vector<std::uint16_t> colours;
  const double step = double(window_voxels) / quads;
  for (int y = 0; y <= quads; ++y)
    for (int x = 0; x <= quads; ++x) {
      position.insert(position.end(),
                      {float(x * step), float(y * step), ground_height(x * step, y * step, window_voxels)});
      if (uv) coordinates.insert(coordinates.end(), {float(x * 0.13), float(y * 0.03)});
      if (rgba)
        colours.insert(colours.end(), {std::uint16_t(x * 997), std::uint16_t(y * 1999), std::uint16_t(x * y * 31),
                                       std::uint16_t(65535 - x * 100)});
    }
  for (int y = 0; y < quads; ++y)
    for (int x = 0; x < quads; ++x) {
      const auto a = std::uint32_t(y * (quads + 1) + x), b = a + 1, c = a + std::uint32_t(quads) + 1, d = c + 1;
      index.insert(index.end(), {a, b, d, a, d, c});
    }
  cell.add_part(std::move(position), std::move(index), 0, std::move(coordinates), std::move(colours));
  return cell;
}

TestCell textured_ground() {
  TestCell cell = ground("textured", 64, 24, true, true);
  cell.materials[0] = material(AlphaMode::blend, cell.add_texture(32, 16, TextureAlpha::blend, 1), Wrap::repeat);
  add_textured_sheets(cell, {AlphaMode::opaque, AlphaMode::mask, AlphaMode::blend});
  return cell;
}

TestCell opaque_ground() {
  TestCell cell = ground("opaque", 64, 24, false, true);
  add_textured_sheets(cell, {AlphaMode::opaque});
  TestCell soup = triangle_soup(9);
  const CellInput other = soup.input();
  std::mt19937 random(9);
  for (std::size_t i = 0; i < other.parts.size; ++i) {  // the first part has a texture, the second one colour
    const PartView& p = other.parts[i];
    std::vector<float> uv;
    for (std::size_t v = 0; i == 0 && v < 2 * p.position.size / 3; ++v) uv.push_back(float(random() % 100) / 10);
    cell.add_part({p.position.data, p.position.data + p.position.size}, {p.index.data, p.index.data + p.index.size}, 1,
                  std::move(uv));
  }
  return cell;
}

TestCell triangle_soup(unsigned seed) {
  TestCell cell;
  cell.name = "soup " + std::to_string(seed);
  cell.window_voxels = 128;
  cell.materials = {material(AlphaMode::opaque, -1, Wrap::repeat), material(AlphaMode::blend, -1, Wrap::repeat)};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::uint32_t part = 0; part < 2; ++part) {
    std::vector<float> position;
    std::vector<std::uint32_t> index;
    for (std::uint32_t t = 0; t < 3000; ++t) {
      const double reach = std::pow(10.0, -3 + 5 * std::fabs(unit(random))) * (t % 300 == 0 ? 1000 : 1);
      const double centre[3] = {64 + 70 * unit(random), 64 + 70 * unit(random), 64 + 70 * unit(random)};
      for (int v = 0; v < 3; ++v) {
        for (const double c : centre) {
          const double x = c + reach * unit(random);
          position.push_back(float(t % 5 == 0 ? std::floor(x) : x));
        }
        index.push_back(3 * t + std::uint32_t(v));
      }
    }
    cell.add_part(std::move(position), std::move(index), part);
  }
  return cell;
}

TestCell crowded_voxel() {
  TestCell cell;
  cell.name = "crowded";
  cell.materials.push_back({});
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  std::vector<std::uint16_t> rgba;
  for (std::uint32_t t = 0; t < 10000; ++t)
    for (std::uint32_t v = 0; v < 3; ++v) {
      const float reach = t < 5000 ? 0.99f : 8;
      for (int c = 0; c < 3; ++c) position.push_back(16 + reach * unit(random));
      for (int c = 0; c < 4; ++c) rgba.push_back(std::uint16_t(random()));
      index.push_back(3 * t + v);
    }
  cell.add_part(std::move(position), std::move(index), 0, {}, std::move(rgba));
  return cell;
}

TestCell bad_triangles() {
  TestCell cell = ground("bad triangles", 64, 8, true, false);
  cell.materials[0] = material(AlphaMode::opaque, cell.add_texture(8, 8, TextureAlpha::ignore, 3), Wrap::repeat);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  cell.add_part(
      {nan, 0, 0, 1, 0, 0, 0, 1, 0, inf, 3, 3, 4, 4, 4, 5, 3, 5,     1e9f, 1e9f, 2, 2, 9, 1, 1, 1, 2, 2, 2, 3,
       3,   3, 7, 7, 7, 7, 7, 7, 9, 9,   9, 1, 1, 5, 9, 1, 5, 1e15f, 60,   5,    3, 3, 9, 9, 3, 9, 3, 9, 9, 5},
      {0, 1, 2, 3, 4, 5, 6, 7, 1, 8, 9, 10, 11, 11, 12, 14, 15, 16, 17, 18, 19}, 0,
      {0, 0, nan, 0, 0, 1, inf,   1, 2, 2, 0, 0, 1, 1, 0,   0, 1,    1, 0, 0,
       1, 1, 0,   0, 1, 1, 1e30f, 0, 0, 0, 1, 1, 0, 0, nan, 1, 1e7f, 0, 0, 1});
  return cell;
}

TestCell instances() {
  TestCell cell = ground("instances", 128, 3, false, true);
  for (int i = 0; i < 60; ++i)
    cell.add_instance((i * 37) % 128, (i * 53) % 128, (i * 11) % 90, (i % 2 == 0 ? 0.12 : -0.2));
  return cell;
}

TestCell constant_block() {
  TestCell cell;
  cell.name = "constant block";
  cell.window_voxels = 32;
  cell.materials.push_back({});
  std::vector<float> position;
  std::vector<std::uint32_t> index;
  for (std::uint32_t z = 0; z < 16; ++z) {
    const float h = float(z) + 0.5f;
    position.insert(position.end(), {-8, -8, h, 40, -8, h, 40, 40, h, -8, 40, h});
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) index.push_back(4 * z + i);
  }
  cell.add_part(std::move(position), std::move(index), 0);
  return cell;
}

std::list<TestCell> smooth_cells() {
  std::list<TestCell> cells;
  cells.push_back(ground("plain", 64, 20, false, false));
  cells.push_back(textured_ground());
  cells.push_back(opaque_ground());
  cells.push_back(triangle_soup(10));
  cells.push_back(crowded_voxel());
  unsigned seed = 20;
  for (TestCell& cell : cells) cell.add_vertex_normals(seed++);
  cells.push_back(ground("instances", 64, 3, false, true));
  cells.back().add_vertex_normals(seed);
  for (int i = 0; i < 20; ++i)
    cells.back().add_instance((i * 37) % 64, (i * 53) % 64, (i * 11) % 50, (i % 2 == 0 ? 0.12 : -0.2));
  return cells;
}

std::list<TestCell> mapped_cells() {
  std::list<TestCell> cells;
  cells.push_back(ground("plain", 64, 20, false, false));
  cells.push_back(textured_ground());
  cells.push_back(opaque_ground());
  cells.push_back(triangle_soup(11));
  cells.push_back(ground("coloured", 64, 20, false, true));
  cells.push_back(bad_triangles());
  unsigned seed = 30;
  for (TestCell& cell : cells) {
    if (seed % 2 == 0) cell.add_vertex_normals(seed);
    cell.add_normal_maps(seed++);
  }
  cells.push_back(ground("instances", 64, 3, false, true));
  cells.back().add_vertex_normals(seed);
  cells.back().add_normal_maps(seed);
  for (int i = 0; i < 20; ++i)
    cells.back().add_instance((i * 37) % 64, (i * 53) % 64, (i * 11) % 50, (i % 2 == 0 ? 0.12 : -0.2));
  return cells;
}

std::list<TestCell> flat_cells() {
  std::list<TestCell> cells;
  cells.push_back(ground("plain", 64, 20, false, false));
  cells.push_back(ground("coloured", 128, 64, false, true));
  cells.push_back(ground("one brick", 8, 3, false, true));
  cells.push_back(ground("fine", 512, 256, false, true));
  cells.push_back(textured_ground());
  cells.push_back(opaque_ground());
  cells.push_back(triangle_soup(7));
  cells.push_back(triangle_soup(8));
  cells.push_back(crowded_voxel());
  cells.push_back(bad_triangles());
  cells.push_back(instances());
  cells.push_back(constant_block());
  return cells;
}

std::list<TestCell> all_cells() {
  std::list<TestCell> cells = flat_cells();
  cells.splice(cells.end(), smooth_cells());
  cells.splice(cells.end(), mapped_cells());
  return cells;
}

}  // namespace gigabake::kernels::test
