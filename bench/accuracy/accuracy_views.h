/// The cameras from which pictures of voxels and of triangles are compared.
#pragma once

#include <array>
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
/// needs fewer. A view that does not hold the whole scene looks at the surface in its middle. Space   Voxels are those
/// of `lattice`, as the caster's.
std::vector<AccuracyView> accuracy_views(const ReferenceCaster& caster, const BakeParameters& lattice,
                                         const std::vector<double>& voxels_per_pixel, int width, int height);

/// In voxels of `lattice`.
kernels::CastCamera reference_camera(const CameraOptions& camera, const BakeParameters& lattice);

/// So narrow that rays are nearly parallel.
inline constexpr double accuracy_fovy_deg = 1;
/// Where cameras look, from this far above the horizon: towards north-north-west, so that no axis of the lattice is
/// special.
std::array<double, 3> forward_at(double elevation_deg);
Point<Scene> to_scene_m(const std::array<double, 3>& voxels, const BakeParameters& lattice);

}  // namespace gigabake::bench
