/// A ray caster of the source's triangles. It renders the reference images with which images of voxels are compared.
#pragma once

#include <memory>
#include <optional>

#include "bench/accuracy/linear_picture.h"
#include "core/math/vec3.h"
#include "kernels/light/shade.h"
#include "kernels/marching/cast.h"
#include "worker/scan/source_triangles.h"

namespace gigabake::bench {

/// A caster that finds triangles with Embree 3 or 4. Colour is ViewMode::albedo, or lit like voxels by the outer
/// normal of each triangle. Alpha modes have the same meaning as in a bake; translucent surfaces are composited front
/// to back.
/// Space   Lod-0 voxels of `lattice`; only its voxel size and origin are used.
class ReferenceCaster {
 public:
  /// Returns true if gigabake was built with Embree.
  static bool is_built();

  /// Builds the acceleration structure.
  /// Errors  UsageError: built without Embree. InputError: as SourceTriangles.
  ReferenceCaster(const SceneSources& sources, const BakeParameters& lattice, int threads);
  ReferenceCaster(SourceTriangles triangles, int threads);
  ~ReferenceCaster();
  ReferenceCaster(const ReferenceCaster&) = delete;
  ReferenceCaster& operator=(const ReferenceCaster&) = delete;

  /// Returns the bounding box of all triangles.
  const TriangleBox& box() const;
  const SourceTriangles& triangles() const;

  /// Returns all triangles closer to p than `radius`, and some farther triangles, in ascending order. Thread-safe.
  /// Range   `radius` is far above 2^-24 of the box's size.
  std::vector<TriangleName> near(const Vec3d& p, double radius) const;

  /// Renders an image. Each pixel is the mean of at least `samples` rays, one at a random position in each square of a
  /// grid over the pixel.
  /// Exact   Independent of the number of threads, on one machine: pixels seed their own random numbers.
  LinearPicture draw(const kernels::CastCamera& camera, int samples,
                     const kernels::CastLight& light = kernels::unlit()) const;

  /// Renders an image with shadows. Each ray samples one point of the sun's disc. At the hit it also samples one
  /// cosine-weighted direction of the sky. Directions that do not reach the sky return the light of the ground.
  LinearPicture draw_shadowed(const kernels::CastCamera& camera, int samples, const kernels::CastLight& light,
                              double sun_radius_deg) const;

  /// Returns the distance to the first triangle that the ray hits. `direction` is a unit vector.
  std::optional<double> first_hit(const Vec3d& origin, const Vec3d& direction) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gigabake::bench
