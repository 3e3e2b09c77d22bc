/// The CUDA backend of bake_cell(): the same bodies on a GPU, the same bits.
///
/// Built without CUDA (or run without a driver) there are no devices, and cuda_devices() says why.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "kernels/body/cell.h"
#include "lattice/cuda_failure.h"

namespace gigabake::kernels {

struct CudaDevices {
  std::vector<int> usable;  ///< ordinals of devices of compute capability 8.0 or newer
  std::string reason;       ///< why there are none, or fewer than the machine has
};

/// Cost    Starts the driver: about a second at the first call.
CudaDevices cuda_devices();

/// Bytes read and written by a large copy within the device, per second: the rate of a floor.
/// Errors  CudaFailure.
double device_copy_rate(int device);

/// A cell's triangles and textures on the device.
class CudaInput;

/// A baked cell, on the device unless it came in parts.
class CudaVolume {
 public:
  virtual ~CudaVolume() = default;
  virtual const CellStats& stats() const = 0;
};

/// One device. Keeps its memory pool and the textures of recent cells between cells.
/// upload(), bake() and download() may run at the same time on three threads, each for a cell of its own; one of them
/// not twice at the same time.
class CudaBaker {
 public:
  /// device: an ordinal that cuda_devices() named. texture_bytes: device memory for textures of recent cells;
  /// 0: a quarter of what the device has.
  /// Errors  CudaFailure.
  CudaBaker(int device, std::uint64_t texture_bytes);
  ~CudaBaker();
  CudaBaker(const CudaBaker&) = delete;
  CudaBaker& operator=(const CudaBaker&) = delete;

  /// parameters.memory_bytes: of device memory, for the cell's triangles, working arrays and result. A cell that needs
  /// more, or more than the device has left, is baked and downloaded part by part.
  /// Exact   The same volume as kernels::bake_cell(input, parameters, any policy), whatever the memory, but for
  ///         stats.batches (parts here), peak_bytes (device memory here) and times.
  /// Errors  CudaFailure: input or the smallest part does not fit the device, or the device is lost. The baker is as
  ///         good as new afterwards, or every further call fails.
  CellVolume bake_cell(const CellInput& input, const CellParameters& parameters);

  /// The three steps of bake_cell(). The input's arrays must live until upload() returns.
  std::shared_ptr<const CudaInput> upload(const CellInput& input);
  std::unique_ptr<CudaVolume> bake(const CudaInput& input, const CellParameters& parameters);
  /// volume: of this baker. It leaves the device.
  CellVolume download(std::unique_ptr<CudaVolume> volume);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gigabake::kernels
