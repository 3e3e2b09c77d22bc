/// Exact silhouettes of convex bodies: the reference for images of objects without ground. It computes in double and
/// shares no code with the ray caster of the program.
///
/// Space   Lod-0 voxels of a lattice at the scene's origin; voxels are 1 m wide.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "bench/accuracy/leaks/leak_error.h"
#include "core/math/vec3.h"
#include "viewer/pictures/camera.h"

namespace gigabake::bench {

inline Vec3d unit_vector(const Vec3d& v) { return v / std::hypot(v[0], v[1], v[2]); }

/// The convex hull of its corners.
struct ConvexBody {
  std::vector<Vec3d> corners;
};

/// A pinhole camera with an upright image, or north up if it looks straight up or down.
class Pinhole {
 public:
  /// Range   `camera` has an eye and a target, and no `up`.
  explicit Pinhole(const CameraOptions& camera);

  int width() const { return width_; }
  int height() const { return height_; }
  const Vec3d& forward() const { return forward_; }
  const Vec3d& right() const { return right_; }
  const Vec3d& up() const { return up_; }
  /// Returns the position of a point in the image; the upper left corner of the image is (0, 0).
  /// Range   The point lies in front of the eye.
  std::array<double, 2> pixel_of(const Vec3d& p) const;

 private:
  Vec3d eye_, forward_, right_, up_;
  int width_, height_;
  double pixels_per_tangent_;
};

/// Returns the area of the image that the bodies cover together, in pixels.
/// Exact   Lines of the image are sampled `lines_per_pixel` times; along a line the area is exact.
double silhouette_area(const std::vector<ConvexBody>& bodies, const Pinhole& camera, double lines_per_pixel);

/// Returns alpha 1 for pixels whose centre a body covers, and 0 for others.
AlphaPicture silhouettes(const std::vector<ConvexBody>& bodies, const Pinhole& camera);

}  // namespace gigabake::bench
