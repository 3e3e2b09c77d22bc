#include "first_hit_scenes.h"

#include <cmath>
#include <random>

namespace gigabake::first_hit_test {
namespace {

std::uint64_t hash(std::int64_t x, std::int64_t y, std::int64_t z) {
  std::uint64_t h = std::uint64_t((x * 73856093) ^ (y * 19349663) ^ (z * 83492791)) * 0x9e3779b97f4a7c15ull;
  return h ^ h >> 29;
}

}  // namespace

FirstHitScene build(VoxelScene& voxels, int lod) {
  FirstHitBuilder builder(lod);
  for (std::size_t c = 0; c < voxels.shards().size(); ++c)
    builder.add_cell(voxels.description().cells[c].lattice_min, voxels.shards()[c].nodes,
                     voxels.shards()[c].levels[std::size_t(lod)]);
  return builder.finish();
}

kernels::FirstHitRay ray(const std::array<double, 3>& origin, const std::array<double, 3>& direction) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  kernels::FirstHitRay r;
  for (std::size_t a = 0; a < 3; ++a) {
    r.origin[a] = origin[a];
    r.direction[a] = float(direction[a] / length);
  }
  return r;
}

std::vector<kernels::FirstHitRay> random_rays(std::size_t count, double low, double high) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> place(low, high);
  std::normal_distribution<double> towards;
  std::vector<kernels::FirstHitRay> rays;
  while (rays.size() < count) {
    std::array<double, 3> origin, direction;
    for (double& o : origin) o = place(generator);
    for (double& d : direction) d = towards(generator);
    rays.push_back(ray(origin, direction));
  }
  return rays;
}

Painter dust(std::uint64_t sparsity) {
  return [sparsity](std::int64_t x, std::int64_t y, std::int64_t z) -> std::optional<Paint> {
    const bool inside = x >= 0 && y >= 0 && z >= 0 && x < 64 && y < 64 && z < 64;
    if (!inside || hash(x, y, z) % sparsity != 0) return {};
    return Paint{{std::uint8_t(x), std::uint8_t(y), std::uint8_t(z), 255}, {std::int8_t(x), std::int8_t(y)}};
  };
}

std::optional<Paint> hills(std::int64_t x, std::int64_t y, std::int64_t z) {
  if (x < 0 || y < 0 || x >= 128 || y >= 128) return {};
  const double height = 45 + 8 * std::sin(double(x) / 9) + 6 * std::cos(double(y) / 7);
  if (std::fabs(double(z) - height) > 1.5) return {};
  return Paint{};
}

kernels::FirstHitCamera camera(const std::array<double, 3>& eye, const std::array<double, 3>& target,
                               double half_height, bool parallel) {
  kernels::FirstHitCamera c;
  const std::array<double, 3> to{target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]};
  const double length = std::hypot(to[0], to[1], to[2]), level = std::hypot(to[0], to[1]);
  c.width = 163;
  c.height = 97;
  c.per_column = 2.0f / float(c.width);
  c.per_row = 2.0f / float(c.height);
  const double f[3] = {to[0] / length, to[1] / length, to[2] / length};
  const double r[3] = {to[1] / level, -to[0] / level, 0};
  const double u[3] = {r[1] * f[2], -r[0] * f[2], r[0] * f[1] - r[1] * f[0]};
  for (int a = 0; a < 3; ++a) {
    c.eye[a] = eye[std::size_t(a)];
    c.forward[a] = float(f[a]);
    (parallel ? c.across : c.right)[a] = float(r[a] * half_height * c.width / c.height);
    (parallel ? c.upward : c.up)[a] = float(u[a] * half_height);
  }
  return c;
}

std::vector<kernels::FirstHitCamera> cameras_on_hills() {
  return {camera({200, -70, 120}, {64, 64, 45}, 40, true),   camera({200, -70, 120}, {64, 64, 45}, 90, true),
          camera({200, -70, 120}, {64, 64, 45}, 0.3, false), camera({-300, -350, 60}, {64, 64, 45}, 0.2, false),
          camera({64, 64, 50}, {100, 90, 45}, 0.6, false),   camera({64, 64, 20}, {100, 90, 45}, 0.9, false),
          camera({64, 64, 900}, {64.1, 64, 45}, 500, true)};
}

}  // namespace gigabake::first_hit_test
