/// CUDA backend of bake_cell(): the same kernel bodies on a GPU, with the same bits.
///
/// Without CUDA in the build or without a driver there are no devices, and cuda_devices() returns the reason.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "kernels/body/cell.h"

namespace gigabake::kernels {

struct CudaDevices {
  std::vector<int> usable;  ///< ordinals of devices of compute capability 8.0 or newer
  std::string reason;       ///< why there are no usable devices, or fewer than the machine has
};

/// Returns the usable devices.
/// Cost    Starts the driver: about a second at the first call.
CudaDevices cuda_devices();

/// Creates this process's context on the device, so that later calls need not wait for it.
/// Cost    0.15 s; processes of a host wait for each other in the driver.
/// Errors  CudaFailure.
void start_device(int device);

/// Returns the size of the device's memory.
/// Errors  CudaFailure.
std::uint64_t device_memory_bytes(int device);

/// Returns the memory bandwidth of the device: bytes read plus bytes written per second by a large copy. Lower bounds
/// of run times are computed from it.
/// Errors  CudaFailure.
double device_copy_rate(int device);

/// A cell's triangles and textures on the device.
class CudaInput;

/// A baked cell: on the device, or on the host if it was baked in parts.
class CudaVolume {
 public:
  virtual ~CudaVolume() = default;
  virtual const CellStats& stats() const = 0;
};

/// Baker on one device. Keeps its memory pool and the textures of recent cells between cells.
/// Three threads may call upload(), bake() and download() concurrently for different cells. Each of the three functions
/// may run only once at a time.
class CudaBaker {
 public:
  /// `device` is an ordinal from cuda_devices(). `texture_bytes` is the device memory for textures of recent cells; 0
  /// means a quarter of the device's memory.
  /// Errors  CudaFailure.
  CudaBaker(int device, std::uint64_t texture_bytes);
  ~CudaBaker();
  CudaBaker(const CudaBaker&) = delete;
  CudaBaker& operator=(const CudaBaker&) = delete;

  /// Bakes a cell. `parameters.memory_bytes` is the max device memory for triangles, working arrays and result. A cell
  /// that needs more, or more than the device has free, is baked and downloaded in parts.
  /// Exact   Same volume as kernels::bake_cell(input, parameters, any policy), for any memory. Differences:
  ///         stats.batches counts parts, peak_bytes is device memory, and times differ.
  /// Errors  CudaFailure if input or the smallest part does not fit the device, or if the device is lost. The baker
  ///         remains usable unless the device is lost; then every further call fails.
  CellVolume bake_cell(const CellInput& input, const CellParameters& parameters);

  /// Uploads the input of a cell, as the first of the three steps of bake_cell(). The input's arrays must live until
  /// upload() returns.
  std::shared_ptr<const CudaInput> upload(const CellInput& input);
  /// Bakes an uploaded cell, as the second step.
  std::unique_ptr<CudaVolume> bake(const CudaInput& input, const CellParameters& parameters);
  /// Bakes like bake(), but returns null if the cell needs several parts. The memory of volumes that are not freed yet
  /// counts in `parameters.memory_bytes`, so the same cell may need no parts later.
  std::unique_ptr<CudaVolume> bake_at_once(const CudaInput& input, const CellParameters& parameters);
  /// Downloads a volume that this baker has baked, as the third step, and frees its device memory.
  CellVolume download(std::unique_ptr<CudaVolume> volume);

  /// Returns the device memory of the volumes that are not freed yet, between two calls of bake().
  std::uint64_t volume_bytes() const;
  /// Returns the device memory that bake() will probably need; 0 before the first cell. It is the max of the needs of
  /// previous cells, which count an eighth less with each further cell.
  std::uint64_t expected_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
