/// Exceptions for failures of a CUDA device. Modules that do not use CUDA can catch them.
#pragma once

#include <stdexcept>

namespace gigabake {

/// The device has no free memory or is lost. The cell can be baked on another device or on the CPU.
class CudaFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An allocation exceeds the limit, the device's free memory or 32-bit indices. Smaller batches may fit.
class DeviceFull : public CudaFailure {
 public:
  using CudaFailure::CudaFailure;
};

}  // namespace gigabake
