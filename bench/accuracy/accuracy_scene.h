/// A scene prepared for comparison: its triangles and its baked voxels.
#pragma once

#include "bench/accuracy/accuracy_bench.h"
#include "bench/accuracy/reference_caster.h"
#include "format/source/source.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct AccuracyScene {
  SceneSources sources;
  ReferenceCaster caster;
  FrameRenderer::Options renderer;  ///< with request.scene.threads threads

  /// Bakes the scene with the default rules into request.out and replaces an earlier bake there.
  /// Errors  Same as bench_accuracy().
  AccuracyScene(const AccuracyBenchRequest& request, const AccuracyProgress& progress);
};

}  // namespace gigabake::bench
