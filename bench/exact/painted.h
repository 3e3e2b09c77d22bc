/// The expected content of voxels, computed from exact pieces: the averages of colour, alpha and normal in
/// docs/accuracy.md.
#pragma once

#include <map>
#include <optional>

#include "bench/exact/appearance.h"
#include "bench/exact/exact_clip.h"
#include "core/base/rules.h"

namespace gigabake::reference {

struct Painted {
  Triangle triangle;
  Rgba16 colour = white16;  ///< linear, straight alpha
  AlphaMode mode = AlphaMode::opaque;
  std::optional<std::array<Rgba16, 3>> vertex_colours;  ///< opaque colours; their mean is the value at the centroid
};

struct ExpectedVoxel {
  double area = 0;     ///< Σ w over the pieces; w: area of a piece in voxel²
  double visible = 0;  ///< Σ w·a; a: alpha of the piece
  Vec3d colour{};      ///< Σ w·a·c; c: linear colour of the piece
  Direction normal{};  ///< Σ w·a·n; n: unit normal of the piece
  Direction axis{};    ///< Σ w·a·n, each n turned to one half space
  int pieces = 0;
  bool is_at_border = false;  ///< the normal of a piece lies on the half space's border; rounding determines its side

  bool is_opaque = false;  ///< a piece has alpha 1

  double alpha() const { return is_opaque ? 1 : visible / area; }
  /// Returns the visible fraction of the area. The rounding error of colours is inversely proportional to it.
  double visible_fraction() const { return visible / area; }
  double linear(int c) const { return colour[c] / visible; }
  /// Returns the length of the mean normal: the certainty of its direction.
  double certainty() const;
  /// Returns the angle between a stored normal and the expected normal. The normal of a two-sided voxel is its axis, on
  /// either side. If the voxel is nearly two-sided, it may have either normal. The rounding of the axis is not counted.
  double normal_error_deg(const Direction& stored) const;
};

/// Returns every voxel of the window that a triangle occupies, visible or not.
std::map<Voxel, ExpectedVoxel> expected_voxels(const std::vector<Painted>& scene, SurfaceRule rule,
                                               const Window& window);

}  // namespace gigabake::reference
