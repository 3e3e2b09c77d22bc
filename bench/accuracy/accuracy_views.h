/// The cameras from which pictures of voxels and of triangles are compared.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/accuracy/reference_caster.h"
#include "lattice/parameters.h"
#include "viewer/pictures/camera.h"

namespace gigabake::bench {

/// From nearly parallel rays, so that pixels are nearly the same size everywhere: `voxels_per_pixel` where the box
/// around the scene is nearest to the eye, and more behind. So voxels of lod k fill a pixel where it is 2^k.
struct AccuracyView {
  std::string direction;  ///< nadir, oblique (35° above the horizon) or grazing (10°)
  double voxels_per_pixel = 1;
  CameraOptions camera;

  std::string name() const;  ///< "oblique 0.25"
};

/// Voxels a pixel, unless others are asked for.
inline const std::vector<double> accuracy_scales{0.25, 1, 4, 16};

/// Every direction at every scale of `voxels_per_pixel`. At most width × height pixels; fewer where the whole scene
/// needs fewer. Each view that does not hold the whole scene looks at another place of the surface (visible_places()).
/// Space   Voxels are those of `lattice`, as the caster's.
/// Errors  InputError: no triangle of the source is visible.
std::vector<AccuracyView> accuracy_views(const ReferenceCaster& caster, const BakeParameters& lattice,
                                         const std::vector<double>& voxels_per_pixel, int width, int height);

/// Returns at least one and at most `most` places of the visible surface, spread over its area; the same ones each
/// time. Errors  InputError: no triangle is visible.
std::vector<std::array<double, 3>> visible_places(const SourceTriangles& source, std::size_t most);

/// A view that shows the surface in fewer pixels measures nothing.
inline constexpr std::uint64_t min_compared_pixels = 4;
/// Returns in how many pixels the reference shows the surface.
std::uint64_t compared_pixels(const LinearPicture& reference);
/// Errors  InputError(source): pixels is below min_compared_pixels.
void expect_surface(const std::filesystem::path& source, const std::string& view, std::uint64_t pixels);

/// In voxels of `lattice`.
kernels::CastCamera reference_camera(const CameraOptions& camera, const BakeParameters& lattice);

/// So narrow that rays are nearly parallel.
inline constexpr double accuracy_fovy_deg = 1;
/// Where cameras look, from this far above the horizon: towards north-north-west, so that no axis of the lattice is
/// special.
std::array<double, 3> forward_at(double elevation_deg);
Point<Scene> to_scene_m(const std::array<double, 3>& voxels, const BakeParameters& lattice);

}  // namespace gigabake::bench
