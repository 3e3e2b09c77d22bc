/// The CUDA backend of first hits: the scene is resident on the device, which casts images and rays.
///
/// In a build without CUDA the constructor throws; cuda_devices() (kernels/cuda/baker.h) gives the reason.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "query/first_hit/first_hit_cast.h"

namespace gigabake::kernels {

/// First hits on one device. Not thread-safe.
/// Errors  CudaFailure, from every member.
class CudaFirstHits {
 public:
  /// Copies the scene to the device. `device` is an ordinal that cuda_devices() returned.
  CudaFirstHits(int device, const FirstHitView& scene);
  ~CudaFirstHits();
  CudaFirstHits(const CudaFirstHits&) = delete;
  CudaFirstHits& operator=(const CudaFirstHits&) = delete;

  /// Uploads rays for cast().
  /// Errors  std::length_error: more than 2^31 rays.
  void upload(Span<const FirstHitRay> rays);

  /// Casts rays and returns the seconds that the device needed, measured by its own clock. Results stay on the device
  /// until the next cast. If `attributes`, attributes of the hit voxels are fetched too.
  /// Exact   The same bits as cast_first_hits().
  double cast(const FirstHitCamera& camera, bool attributes);
  double cast(bool attributes);

  /// Returns the hits of the last cast. attributes() returns the attributes of these hits, or an empty vector if the
  /// cast did not fetch attributes.
  std::vector<FirstHit> hits() const;
  std::vector<VoxelAttributes> attributes() const;

  std::uint64_t device_bytes() const;  ///< device memory that the scene occupies

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
