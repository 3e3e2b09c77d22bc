#include "kernels/cuda/device/upload_ring.cuh"

namespace gigabake::kernels {

UploadRing::~UploadRing() {
  for (const Part& part : parts_) cudaEventSynchronize(part.copied.handle);  // the device may still read the buffers
}

std::byte* UploadRing::reserve(std::size_t bytes) {
  turn_ = (turn_ + 1) % parts_.size();
  bytes_ = bytes;
  Part& part = parts_[turn_];
  wait_for(part.copied.handle, "cudaEventSynchronize");
  if (part.device.size() < bytes) part.device = DeviceArray<std::byte>(heap_, bytes + bytes / 2);
  return part.host.reserve(part.device.size());
}

const std::byte* UploadRing::send() {
  Part& part = parts_[turn_];
  std::byte* const host = part.host.reserve(bytes_);
  upload_async(part.device.data(), host, bytes_, heap_.stream(), "cudaMemcpyAsync");
  check_cuda(cudaEventRecord(part.copied.handle, heap_.stream()), "cudaEventRecord");
  return part.device.data();
}

}  // namespace gigabake::kernels
