/// The cameras for comparing images of voxels with images of triangles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/accuracy/reference_caster.h"
#include "core/math/vec3.h"
#include "core/octree/parameters.h"
#include "viewer/pictures/camera.h"

namespace gigabake::bench {

/// A camera with nearly parallel rays, so that pixels have nearly the same size everywhere. `voxels_per_pixel` is the
/// number where the scene's bounding box is nearest to the eye; farther away it is larger. If it is 2^k, a voxel of lod
/// k fills a pixel.
struct AccuracyView {
  std::string direction;  ///< nadir, oblique (35° above the horizon) or grazing (10°)
  double voxels_per_pixel = 1;
  CameraOptions camera;

  std::string name() const;  ///< such as "oblique 0.25"
};

/// The default numbers of voxels per pixel.
inline const std::vector<double> accuracy_scales{0.25, 1, 4, 16};

/// Returns the views from every direction at every scale of `voxels_per_pixel`. An image has at most width × height
/// pixels, and fewer if fewer pixels show the whole scene. Views that cannot show the whole scene show different places
/// of the surface (visible_places()).
/// Space   Voxels of `lattice`, which is also the lattice of the caster.
/// Errors  InputError: no triangle of the source is visible.
std::vector<AccuracyView> accuracy_views(const ReferenceCaster& caster, const BakeParameters& lattice,
                                         const std::vector<double>& voxels_per_pixel, int width, int height);

/// Returns at least one and at most `maximum` places of the visible surface, distributed over its area. The result is
/// deterministic.
/// Errors  InputError: no triangle is visible.
std::vector<Vec3d> visible_places(const SourceTriangles& source, std::size_t maximum);

/// The minimum number of pixels that must show the surface, so that a view measures something.
inline constexpr std::uint64_t min_compared_pixels = 4;
/// Returns the number of pixels in which the reference shows the surface.
std::uint64_t compared_pixels(const LinearPicture& reference);
/// Rejects a view that shows too little surface.
/// Errors  InputError(source): pixels is below min_compared_pixels.
void expect_surface(const std::filesystem::path& source, const std::string& view, std::uint64_t pixels);

/// Converts a camera to lattice coordinates.
/// Space   Voxels of `lattice`.
kernels::CastCamera reference_camera(const CameraOptions& camera, const BakeParameters& lattice);

/// A field of view so narrow that rays are nearly parallel.
inline constexpr double accuracy_fovy_deg = 1;
/// Returns the view direction of a camera at this elevation above the horizon. The direction points north-west, so that
/// it is not parallel to an axis of the lattice. At an elevation of 90° it points straight down.
Vec3d forward_at(double elevation_deg);
Point<Scene> to_scene_m(const Vec3d& voxels, const BakeParameters& lattice);

}  // namespace gigabake::bench
