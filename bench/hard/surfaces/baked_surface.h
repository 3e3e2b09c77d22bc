/// A baked scene of a surface case, and its images.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "bench/hard/hard_case.h"
#include "bench/hard/surfaces/surface_scene.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

class BakedSurface {
 public:
  /// Writes the scene into `folder`, which is replaced, and bakes it with voxels of 1 m.
  /// Errors  InputError: as a bake.
  BakedSurface(const SurfaceScene& scene, const std::filesystem::path& folder, const HardMachine& machine);

  std::uint64_t voxels() const { return voxels_; }
  /// Calls visit(centre, normal) for each lod-0 voxel: its centre and the octahedral code of its normal.
  void for_each_normal(const std::function<void(const Vec3d& centre, const std::int8_t* normal)>& visit) const;
  /// Renders an exact image with a transparent background and with linear light.
  /// Errors  InputError: the scene cannot be read.
  Picture image(const CameraOptions& camera, ViewMode mode, Shadows shadows = Shadows::off,
                const SunDirection& sun = {});

 private:
  std::filesystem::path folder_;
  std::uint64_t voxels_ = 0;
  std::unique_ptr<FrameRenderer> renderer_;
};

/// Returns a camera that looks from `direction`, a unit vector, at `target`. Its rays are nearly parallel; a pixel is
/// `voxels_per_pixel` wide at the target.
CameraOptions narrow_camera(const Vec3d& target, const Vec3d& direction, double voxels_per_pixel, int width,
                            int height);

HardResult measure_area(const SurfaceScene& scene, const HardRange& goal, BakedSurface& baked);
HardResult measure_wall(const WallScene& wall, BakedSurface& baked);
HardResult measure_inside(const HouseScene& house, BakedSurface& baked);

}  // namespace gigabake::bench
