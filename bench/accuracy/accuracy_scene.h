/// A scene as it is compared: its triangles, and its voxels, baked.
#pragma once

#include "bench/accuracy/accuracy_bench.h"
#include "bench/accuracy/reference_caster.h"
#include "format/source/source.h"
#include "viewer/pictures/frame_renderer.h"

namespace gigabake::bench {

struct AccuracyScene {
  SceneSources sources;
  ReferenceCaster caster;
  FrameRenderer::Options renderer;  ///< of the request's threads

  /// Bakes the scene with the default rules into request.out, in place of what was baked there.
  /// Errors  as bench_accuracy().
  AccuracyScene(const AccuracyBenchRequest& request, const AccuracyProgress& progress);
};

}  // namespace gigabake::bench
