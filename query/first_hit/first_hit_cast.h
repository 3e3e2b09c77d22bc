/// First hits of many rays on the CPU, and code that both backends share.
#pragma once

#include "core/base/thread_pool.h"
#include "query/first_hit/first_hit_camera.h"

namespace gigabake::kernels {

/// The results, one entry per ray. The rays of an image are ordered row by row.
struct FirstHitResult {
  Span<FirstHit> hits;
  Span<VoxelAttributes> attributes;  ///< attributes of the hit voxels, zero for a miss; empty: not requested
};

/// Returns beams for the smallest tiles whose rays stay within the shell's reach up to the scene's centre. Returns
/// beams with `tile` = 0 if no tile size qualifies.
FirstHitBeams plan_beams(const FirstHitView& scene, const FirstHitCamera& camera);

void cast_first_hits(const FirstHitView& scene, const FirstHitCamera& camera, const FirstHitResult& result,
                     const ThreadPool& pool);
void cast_first_hits(const FirstHitView& scene, Span<const FirstHitRay> rays, const FirstHitResult& result,
                     const ThreadPool& pool);

}  // namespace gigabake::kernels
