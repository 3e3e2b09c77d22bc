/// First hits of many rays on the CPU, and what both backends share.
#pragma once

#include "kernels/cast/first_hit_camera.h"
#include "lattice/thread_pool.h"

namespace gigabake::kernels {

/// One entry a ray; a picture's, row by row.
struct FirstHitResult {
  Span<FirstHit> hits;
  Span<FirstHitLook> looks;  ///< of what was met, zero where nothing was; empty: not asked for
};

/// The finest beams whose rays keep together as far as to the scene's middle.
FirstHitBeams plan_beams(const FirstHitView& scene, const FirstHitCamera& camera);

void cast_first_hits(const FirstHitView& scene, const FirstHitCamera& camera, const FirstHitResult& result,
                     const ThreadPool& pool);
void cast_first_hits(const FirstHitView& scene, Span<const FirstHitRay> rays, const FirstHitResult& result,
                     const ThreadPool& pool);

}  // namespace gigabake::kernels
