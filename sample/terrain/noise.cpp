#include "sample/terrain/noise.h"

#include <cmath>

namespace gigabake::sample {

std::uint32_t hash_of(std::uint32_t seed, std::int32_t x, std::int32_t y) {
  std::uint32_t h = seed * 0x9e3779b1u ^ std::uint32_t(x) * 0x85ebca77u ^ std::uint32_t(y) * 0xc2b2ae3du;
  h ^= h >> 16;
  h *= 0x7feb352du;
  h ^= h >> 15;
  h *= 0x846ca68bu;
  h ^= h >> 16;
  return h;
}

double smooth_step(double from, double to, double x) {
  const double t = clamp01((x - from) / (to - from));
  return t * t * (3 - 2 * t);
}

namespace {

/// Returns the dot product of the gradient at a lattice corner and the offset (dx, dy) from the corner.
double corner(std::uint32_t seed, std::int32_t x, std::int32_t y, double dx, double dy) {
  const std::uint32_t h = hash_of(seed, x, y);
  const double gx = (h & 0xffff) * (2.0 / 65535.0) - 1, gy = (h >> 16) * (2.0 / 65535.0) - 1;
  return gx * dx + gy * dy;
}

double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

}  // namespace

double noise(std::uint32_t seed, double x, double y) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = std::int32_t(fx), iy = std::int32_t(fy);
  const double dx = x - fx, dy = y - fy, u = fade(dx);
  const double low = lerp(corner(seed, ix, iy, dx, dy), corner(seed, ix + 1, iy, dx - 1, dy), u);
  const double high = lerp(corner(seed, ix, iy + 1, dx, dy - 1), corner(seed, ix + 1, iy + 1, dx - 1, dy - 1), u);
  return lerp(low, high, fade(dy));
}

double fractal_noise(std::uint32_t seed, double x, double y, int octaves) {
  double sum = 0, amplitude = 1, total = 0;
  for (int i = 0; i < octaves; ++i, amplitude *= 0.5) {
    sum += amplitude * noise(seed + std::uint32_t(i), x, y);
    total += amplitude;
    // A rotation between octaves hides the lattice.
    const double turned = 1.6 * x - 1.2 * y;
    y = 1.2 * x + 1.6 * y;
    x = turned;
  }
  return sum / total;
}

double ridged_noise(std::uint32_t seed, double x, double y, int octaves) {
  double sum = 0, amplitude = 1, total = 0, weight = 1;
  for (int i = 0; i < octaves; ++i, amplitude *= 0.5) {
    const double crest = 1 - clamp01(2 * std::fabs(noise(seed + std::uint32_t(i), x, y)));
    sum += amplitude * weight * crest * crest;
    total += amplitude;
    weight = clamp01(crest * 1.5);
    const double turned = 1.6 * x - 1.2 * y;
    y = 1.2 * x + 1.6 * y;
    x = turned;
  }
  return sum / total;
}

}  // namespace gigabake::sample
