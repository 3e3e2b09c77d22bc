/// Where a picture is taken from.
#pragma once

#include <array>
#include <optional>

#include "format/frames.h"
#include "format/scene_xml.h"
#include "kernels/cast.h"
#include "viewer/cell_reader.h"

namespace gigabake {

struct CameraOptions {
  std::optional<Point<Scene>> eye_m;     ///< default: in the south-east, just far enough to see the whole scene
  std::optional<Point<Scene>> target_m;  ///< default: the middle of what there is
  std::optional<Point<Scene>> up;        ///< default: z; north where the camera looks straight up or down
  double fovy_deg = 40;
  int width = 1280, height = 720;
  double lod_bias = 0;  ///< levels coarser (or finer, below 0) than a pixel
};

/// In lod-0 voxels of the scene's lattice.
struct VoxelBox {
  std::array<double, 3> min, max;
};

/// A box around every voxel, to within eight voxels.
/// Cost    Reads every cell's node table once, one at a time.
/// Errors  InputError.
VoxelBox occupied_box(const SceneDescription& scene, const CellReader& reader);

/// Reads node tables only where eye or target are left open.
/// Errors  UsageError naming the option: not finite, no direction, sizes or angles out of range; InputError.
kernels::CastCamera make_camera(const CameraOptions& options, const SceneDescription& scene, const CellReader& reader);

}  // namespace gigabake
