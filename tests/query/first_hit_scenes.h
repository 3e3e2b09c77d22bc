/// Scenes, rays and cameras for tests of first hits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "query/first_hit/first_hit_camera.h"
#include "query/first_hit_scene.h"
#include "tests/viewer/voxel_scene.h"

namespace gigabake::first_hit_test {

inline constexpr unsigned seed = 20261121;

FirstHitScene build(VoxelScene& voxels, int lod = 0);

/// Returns a ray. `direction` may have any length.
kernels::FirstHitRay ray(const std::array<double, 3>& origin, const std::array<double, 3>& direction);
/// Returns rays with origins in the box [low, high)³ of the lattice and random directions.
std::vector<kernels::FirstHitRay> random_rays(std::size_t count, double low, double high);

/// Paints 1/sparsity of the voxels of the cube [0, 64)³; colour and normal encode the position.
Painter dust(std::uint64_t sparsity);
/// Paints hills between z 30 and 60, 128 voxels wide.
std::optional<Paint> hills(std::int64_t x, std::int64_t y, std::int64_t z);

/// Returns a camera of 163 × 97 pixels. `half_height` is half the image's height: in voxels if `parallel`, otherwise a
/// tangent.
kernels::FirstHitCamera camera(const std::array<double, 3>& eye, const std::array<double, 3>& target,
                               double half_height, bool parallel);
/// Returns cameras near and far, above and below the hills, with and without beams.
std::vector<kernels::FirstHitCamera> cameras_on_hills();

}  // namespace gigabake::first_hit_test
