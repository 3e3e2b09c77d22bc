/// Pictures of the source's triangles themselves: what a picture of voxels is held against.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "bench/accuracy/linear_picture.h"
#include "kernels/cast/cast.h"
#include "kernels/cast/shade.h"
#include "worker/source_triangles.h"

namespace gigabake::bench {

/// Rays find triangles with Embree 3 or 4. Own colour, as ViewMode::albedo, or lit as voxels are, by the outside of
/// each triangle; alpha modes as a bake takes them, front to back through whatever is translucent. Space   Lod-0 voxels
/// of `lattice`; of it only voxel size and origin matter.
class ReferenceCaster {
 public:
  /// Whether gigabake was built with Embree.
  static bool is_built();

  /// Errors  UsageError: built without; InputError: as SourceTriangles.
  ReferenceCaster(const SceneSources& sources, const BakeParameters& lattice, int threads);
  ~ReferenceCaster();
  ReferenceCaster(const ReferenceCaster&) = delete;
  ReferenceCaster& operator=(const ReferenceCaster&) = delete;

  /// Around all triangles.
  const TriangleBox& box() const;
  const SourceTriangles& triangles() const;

  /// Every triangle that comes nearer to p than that, and some that do not; ascending. Any number of threads.
  /// Range   radius: far above 2^-24 of the box's size.
  std::vector<TriangleName> near(const std::array<double, 3>& p, double radius) const;

  /// Each pixel is the mean of at least `samples` rays, one at random in each square of a grid over it.
  /// Exact   The same for any number of threads, on one machine: pixels seed their own random numbers.
  LinearPicture draw(const kernels::CastCamera& camera, int samples,
                     const kernels::CastLight& light = kernels::unlit()) const;

  /// The same where triangles stand in the light: each ray looks at one point of the sun's disc, and from what it meets
  /// at one of the sky, of which those nearer to the surface's normal are the more likely. What is no sky sends what
  /// the ground sends.
  LinearPicture draw_shadowed(const kernels::CastCamera& camera, int samples, const kernels::CastLight& light,
                              double sun_radius_deg) const;

  /// Distance to the first triangle; direction: unit.
  std::optional<double> first_hit(const std::array<double, 3>& origin, const std::array<double, 3>& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake::bench
