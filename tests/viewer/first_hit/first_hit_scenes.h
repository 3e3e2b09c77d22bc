/// Scenes, rays and cameras for tests of first hits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernels/cast/first_hit_camera.h"
#include "tests/viewer/voxel_scene.h"
#include "viewer/first_hit/first_hit_scene.h"

namespace gigabake::first_hit_test {

inline constexpr unsigned seed = 20261121;

FirstHitScene build(VoxelScene& voxels, int lod = 0);

/// direction: of any length.
kernels::FirstHitRay ray(const std::array<double, 3>& origin, const std::array<double, 3>& direction);
/// Origins in the box [low, high)³ of the lattice, directions anywhere.
std::vector<kernels::FirstHitRay> random_rays(std::size_t count, double low, double high);

/// One voxel in `sparsity` of the cube [0, 64)³; its colour and normal say where it is.
Painter dust(std::uint64_t sparsity);
/// Hills between z 30 and 60, 128 voxels wide.
std::optional<Paint> hills(std::int64_t x, std::int64_t y, std::int64_t z);

/// 163 pixels by 97. half_height: of the picture in voxels where `parallel`, else a tangent.
kernels::FirstHitCamera camera(const std::array<double, 3>& eye, const std::array<double, 3>& target,
                               double half_height, bool parallel);
/// From far and near, above and below the hills: with and without beams.
std::vector<kernels::FirstHitCamera> cameras_on_hills();

}  // namespace gigabake::first_hit_test
