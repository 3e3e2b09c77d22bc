/// What can go wrong on a CUDA device, as an exception: rooms that know nothing of CUDA can catch it.
#pragma once

#include <stdexcept>

namespace gigabake {

/// No memory left on the device, or the device is lost. The cell can be baked elsewhere.
class CudaFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// More than is allowed, more than the device has left, or more than 32-bit indices count. Less at a time may fit.
class DeviceFull : public CudaFailure {
 public:
  using CudaFailure::CudaFailure;
};

}  // namespace gigabake
