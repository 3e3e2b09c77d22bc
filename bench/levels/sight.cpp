#include "bench/levels/sight.h"

#include <algorithm>
#include <cmath>

#include "bench/levels/grid_walk.h"

namespace gigabake::bench {
namespace {

const Block* block_at(const Blocks& blocks, const BlockIndex& index) {
  const auto found = blocks.find(index);
  return found == blocks.end() ? nullptr : &found->second;
}

Vector3 point_of(const SightRay& ray, double distance) {
  Vector3 p;
  for (std::size_t a = 0; a < 3; ++a) p[a] = ray.origin[a] + ray.direction[a] * distance;
  return p;
}

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Returns true if the ray crosses an occupied cube of `edge` finest voxels. The callback exists(block, x, y, z)
/// returns true for occupied cubes of a block.
template <class Exists>
bool meets_part(const Blocks& blocks, const SightRay& ray, double length, int edge, const Exists& exists) {
  bool met = false;
  walk_grid(ray, block_edge, 0, length, [&](const BlockIndex& index, double from, double to) {
    const Block* block = block_at(blocks, index);
    if (block == nullptr) return true;
    const int parts = block_edge / edge;
    walk_grid(ray, edge, from, to, [&](const BlockIndex& part, double, double) {
      std::array<int, 3> local;
      for (std::size_t a = 0; a < 3; ++a) {
        local[a] = int(part[a] - index[a] * parts);
        if (local[a] < 0 || local[a] >= parts) return true;  // rounded to beyond the block's face
      }
      met = exists(*block, local[0], local[1], local[2]);
      return !met;
    });
    return !met;
  });
  return met;
}

/// Returns the opaque layers that a ray of this direction crosses per block edge of its length.
double by_facing(const Block& b, const Vector3& d) {
  return b.facing[0] * std::abs(d[0]) + b.facing[1] * std::abs(d[1]) + b.facing[2] * std::abs(d[2]);
}

double by_spread(const Block& b, const Vector3& d) {
  return b.area * std::hypot(b.spread[0] * d[0], b.spread[1] * d[1], b.spread[2] * d[2]);
}

template <class Crossings>
double add_up(const Blocks& blocks, const SightRay& ray, double length, const Crossings& crossings) {
  double covered = 0;
  walk_grid(ray, block_edge, 0, length, [&](const BlockIndex& index, double from, double to) {
    if (const Block* block = block_at(blocks, index))
      covered += crossings(*block, ray.direction) * (to - from) / block_edge;
    return covered < 1;
  });
  return std::min(covered, 1.0);
}

double three_coverages(const Blocks& blocks, const SightRay& ray, double length) {
  return add_up(blocks, ray, length, by_facing);
}

double sggx(const Blocks& blocks, const SightRay& ray, double length) { return add_up(blocks, ray, length, by_spread); }

double parts_4(const Blocks& blocks, const SightRay& ray, double length) {
  return meets_part(blocks, ray, length, 4,
                    [](const Block& b, int x, int y, int z) { return (b.parts >> (x + 4 * y + 16 * z) & 1) != 0; });
}

/// Implements ESVO's contours: a coherent block is its plane, clipped to the block. The incoherent fraction of a block
/// is rendered by its three coverages.
double plane_where_coherent(const Blocks& blocks, const SightRay& ray, double length) {
  double covered = 0, light = 1;
  walk_grid(ray, block_edge, 0, length, [&](const BlockIndex& index, double from, double to) {
    const Block* b = block_at(blocks, index);
    if (b == nullptr) return true;
    covered += (1 - b->coherence) * by_facing(*b, ray.direction) * (to - from) / block_edge;
    Vector3 centre;
    for (std::size_t a = 0; a < 3; ++a) centre[a] = (double(index[a]) + 0.5) * block_edge;
    const double slope = dot(b->normal, ray.direction);
    const double at = slope == 0 ? -1 : (b->offset + dot(b->normal, centre) - dot(b->normal, ray.origin)) / slope;
    if (b->coherence > 0 && at >= from && at <= to) light *= 1 - b->coherence * b->share;
    return covered < 1 && light > 0;
  });
  return 1 - light * (1 - std::min(covered, 1.0));
}

/// The eight blocks around a point, interpolated between their centres.
struct Blend {
  double weight = 0;    ///< sum of the weights of the existing blocks
  double sheet = 0;     ///< sum of weight · coherence
  double distance = 0;  ///< sum of weight · coherence · signed distance of the point from the block's plane
  Vector3 facing{};
  Vector3 normal{};                 ///< sum of weight · coherence · normal
  std::array<double, 8> share{};    ///< fraction of each block's plane that is surface
  std::array<double, 3> between{};  ///< interpolation weights of the point, 0 … 1
};

Blend blend_at(const Blocks& blocks, const Vector3& p) {
  Blend r;
  BlockIndex base;
  for (std::size_t a = 0; a < 3; ++a) {
    const double u = p[a] / block_edge - 0.5;
    base[a] = std::int64_t(std::floor(u));
    r.between[a] = u - double(base[a]);
  }
  for (std::size_t c = 0; c < 8; ++c) {
    BlockIndex index;
    double w = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool upper = (c >> a & 1) != 0;
      index[a] = base[a] + upper;
      w *= upper ? r.between[a] : 1 - r.between[a];
    }
    const Block* b = block_at(blocks, index);
    if (b == nullptr || w == 0) continue;
    r.weight += w;
    r.sheet += w * b->coherence;
    double above = -b->offset;
    for (std::size_t a = 0; a < 3; ++a) {
      above += b->normal[a] * (p[a] - (double(index[a]) + 0.5) * block_edge);
      r.facing[a] += w * b->facing[a];
      r.normal[a] += w * b->coherence * b->normal[a];
    }
    r.distance += w * b->coherence * above;
    r.share[c] = b->share;
  }
  return r;
}

/// Returns the fraction of the blended surface at the point that is surface. The blocks' weighted fractions are divided
/// by the weight of the blocks that its tangent plane crosses. A block does not count as crossed if the plane cuts only
/// a corner.
double share_of_sheet(const Blend& b) {
  const double length = std::hypot(b.normal[0], b.normal[1], b.normal[2]);
  if (length == 0) return 0;
  const double reach = 1.0 / 3 * (std::abs(b.normal[0]) + std::abs(b.normal[1]) + std::abs(b.normal[2])) / length;
  double there = 0, met = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    double w = 1, away = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool upper = (c >> a & 1) != 0;
      w *= upper ? b.between[a] : 1 - b.between[a];
      away += b.normal[a] / length * ((upper ? 1 : 0) - b.between[a]);
    }
    if (std::abs(away) <= reach) met += w;
    there += w * std::min(1.0, 1.15 * b.share[c]);
  }
  return met == 0 ? 1 : std::min(1.0, there / met);
}

/// Models the product's rays: interpolated coverages, samples half a block apart, and a steep opacity function.
double interpolated_coverages(const Blocks& blocks, const SightRay& ray, double length) {
  double covered = 0;
  for (double t = block_edge / 4.0; t < length && covered < 1; t += block_edge / 2.0) {
    const Blend b = blend_at(blocks, point_of(ray, t));
    Vector3 c;
    for (std::size_t a = 0; a < 3; ++a) c[a] = b.facing[a] * std::abs(ray.direction[a]);
    covered += 0.5 * (0.75 * (c[0] + c[1] + c[2]) + 0.25 * std::hypot(c[0], c[1], c[2]));
  }
  covered = std::min(covered, 1.0);
  return covered * covered * (3 - 2 * covered);
}

/// Blends the planes of neighbouring blocks. The surface is where the blended distance changes its sign, which leaves
/// no gap between two blocks. The incoherent fraction is rendered by its three coverages.
double blended_planes(const Blocks& blocks, const SightRay& ray, double length) {
  double covered = 0, light = 1, before = 0, t_before = 0;
  for (double t = block_edge / 4.0; t < length && covered < 1 && light > 0; t += block_edge / 2.0) {
    const Blend b = blend_at(blocks, point_of(ray, t));
    if (b.weight == 0) {
      before = 0;
      continue;
    }
    const double loose = std::min(1.0, 3 * (1 - b.sheet / b.weight));
    for (std::size_t a = 0; a < 3; ++a) covered += 0.5 * loose * b.facing[a] * std::abs(ray.direction[a]);
    const double distance = b.sheet > 0 ? b.distance / b.sheet : 0;
    if (before * distance < 0) {
      const double at = t_before + (t - t_before) * before / (before - distance);
      light *= 1 - share_of_sheet(blend_at(blocks, point_of(ray, at)));
    }
    before = distance;
    t_before = t;
  }
  return 1 - light * (1 - std::min(covered, 1.0));
}

}  // namespace

bool meets_voxel(const Blocks& blocks, const SightRay& ray, double length) {
  return meets_part(blocks, ray, length, 1, [](const Block& b, int x, int y, int z) {
    return bool(b.voxels[std::size_t(x + block_edge * (y + block_edge * z))]);
  });
}

const std::vector<NamedCandidate>& level_candidates() {
  static const std::vector<NamedCandidate> all = {
      {"three coverages, interpolated (today)", 3, interpolated_coverages},
      {"three coverages", 3, three_coverages},
      {"SGGX without rotation", 4, sggx},
      {"4x4x4 parts", 8, parts_4},
      {"plane where coherent", 5, plane_where_coherent},
      {"blended planes", 5, blended_planes},
  };
  return all;
}

}  // namespace gigabake::bench
