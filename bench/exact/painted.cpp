#include "bench/exact/painted.h"

#include <algorithm>
#include <numbers>

#include "core/base/rules.h"

namespace gigabake::reference {
namespace {

constexpr double min_weight = 1.0 / 68719476736.0;  // 2^-36 voxel²

/// Returns the distance of a unit vector from the border of the half space of docs/voxels.md.
double above_border(const Direction& n) { return (9973 * n[0] + 17327 * n[1] + 31469 * n[2]) / 37283; }

Direction unit_normal(const Triangle& t) {
  const auto n = normal_of(t);
  const Direction d{n[0].get_d(), n[1].get_d(), n[2].get_d()};
  return d / length(d);
}

std::array<double, 4> colour_on(const Painted& p, const Piece& piece) {
  std::array<double, 4> colour;
  for (int c = 0; c < 4; ++c) colour[c] = p.colour[c] / 65535.0;
  if (p.mode == AlphaMode::opaque) colour[3] = 1;
  if (p.mode == AlphaMode::mask) colour[3] = p.colour[3] >= 32768 ? 1 : 0;
  if (!p.vertex_colours || area_voxel2(piece, p.triangle) == 0) return colour;
  const auto b = centroid_barycentric(piece, p.triangle);
  for (int c = 0; c < 3; ++c) {
    double mean = 0;
    for (int k = 0; k < 3; ++k) mean += b[k].get_d() * (*p.vertex_colours)[k][c] / 65535.0;
    colour[c] *= mean;
  }
  return colour;
}

}  // namespace

double ExpectedVoxel::certainty() const { return length(normal) / visible; }

double ExpectedVoxel::normal_error_deg(const Direction& stored) const {
  const double sides = certainty(), both = length(axis) / visible;
  const double lost = pieces / (4096 * visible);  // weights of the axis are multiples of 2^-12 voxel²
  const bool may_be_two_sided = sides < 0.52 && both > 0.78 - lost,
             must_be_two_sided = sides < 0.48 && both > 0.82 + lost && !is_at_border;
  const double one = must_be_two_sided ? 180 : angle_deg(stored, normal);
  if (!may_be_two_sided) return one;
  const double rounding = 0.4 + 180 / std::numbers::pi * lost / both;  // normals of the axis have 8 bits
  const double two = std::min(angle_deg(stored, axis), angle_deg(stored, axis * -1)) - rounding;
  return std::min(one, std::max(two, 0.0));
}

std::map<Voxel, ExpectedVoxel> expected_voxels(const std::vector<Painted>& scene, SurfaceRule rule,
                                               const Window& window) {
  std::map<Voxel, ExpectedVoxel> out;
  for (const Painted& p : scene) {
    const std::vector<Piece> pieces = pieces_in(p.triangle, window);
    const std::set<Voxel> hit = occupied(p.triangle, pieces, rule);
    const Direction normal = unit_normal(p.triangle);
    for (const Piece& piece : pieces) {
      if (!hit.count(piece.voxel)) continue;
      ExpectedVoxel& v = out[piece.voxel];
      const double w = std::max(min_weight, area_voxel2(piece, p.triangle));
      const auto colour = colour_on(p, piece);
      v.area += w;
      v.is_opaque = v.is_opaque || colour[3] == 1;
      v.visible += w * colour[3];
      v.colour += Vec3d::from(colour) * (w * colour[3]);
      v.normal += normal * (w * colour[3]);
      v.axis += normal * (w * colour[3] * (above_border(normal) < 0 ? -1 : 1));
      v.is_at_border = v.is_at_border || std::abs(above_border(normal)) < 1e-4;
      ++v.pieces;
    }
  }
  return out;
}

}  // namespace gigabake::reference
