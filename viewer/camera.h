/// Where a picture is taken from.
#pragma once

#include <array>
#include <optional>

#include "format/frames.h"
#include "format/scene_xml.h"
#include "kernels/cast.h"
#include "viewer/page.h"

namespace gigabake {

struct CameraOptions {
  std::optional<Point<Scene>> eye_m;     ///< default: in the south-east, just far enough to see the whole scene
  std::optional<Point<Scene>> target_m;  ///< default: the middle of what there is
  std::optional<Point<Scene>> up;        ///< default: z; north where the camera looks straight up or down
  double fovy_deg = 40;
  int width = 1280, height = 720;
  double lod_bias = 0;  ///< levels coarser (or finer, below 0) than a pixel
};

/// Cost    Where eye or target are left open, one read of up to 256 cells' first page of nodes, one at a time.
/// Errors  UsageError naming the option: not finite, no direction, sizes or angles out of range.
kernels::CastCamera make_camera(const CameraOptions& options, const SceneDescription& scene, const PageSource& pages);

}  // namespace gigabake
