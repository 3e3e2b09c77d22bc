/// The CUDA backend of first hits: a scene that stays on the device, pictures and rays cast there.
///
/// Built without CUDA nothing here can be constructed; cuda_devices() (cuda_baker.h) says why.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/cast/first_hit_cast.h"
#include "lattice/cuda_failure.h"

namespace gigabake::kernels {

/// One device, one thread at a time.
/// Errors  CudaFailure, from every member.
class CudaFirstHits {
 public:
  /// Copies the scene to the device. device: an ordinal that cuda_devices() named.
  CudaFirstHits(int device, const FirstHitView& scene);
  ~CudaFirstHits();
  CudaFirstHits(const CudaFirstHits&) = delete;
  CudaFirstHits& operator=(const CudaFirstHits&) = delete;

  /// For cast(). Errors  std::length_error: more than 2^31 rays.
  void upload(Span<const FirstHitRay> rays);

  /// looks: those of what is met are fetched too. The results stay on the device until the next cast; returns the
  /// seconds that the device needed, by its own clock.
  /// Exact   The same bits as cast_first_hits().
  double cast(const FirstHitCamera& camera, bool looks);
  double cast(bool looks);

  /// Of the last cast. looks(): empty where they were not fetched.
  std::vector<FirstHit> hits() const;
  std::vector<FirstHitLook> looks() const;

  std::uint64_t device_bytes() const;  ///< of the scene

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
