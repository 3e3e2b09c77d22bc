#include "kernels/cuda/delivery.cuh"

namespace gigabake::kernels {

Delivery::~Delivery() {
  for (const Part& part : parts_) part.copied.wait_quietly();  // or the device would read what is freed
}

std::byte* Delivery::room(std::size_t bytes) {
  turn_ = (turn_ + 1) % parts_.size();
  bytes_ = bytes;
  Part& part = parts_[turn_];
  part.copied.wait();
  if (part.device.size() < bytes) part.device = DeviceArray<std::byte>(heap_, bytes + bytes / 2);
  return part.host.reserve(part.device.size());
}

const std::byte* Delivery::send() {
  Part& part = parts_[turn_];
  std::byte* const host = part.host.reserve(bytes_);
  check_cuda(cudaMemcpyAsync(part.device.data(), host, bytes_, cudaMemcpyHostToDevice, heap_.stream()),
             "cudaMemcpyAsync");
  part.copied.record(heap_.stream());
  return part.device.data();
}

}  // namespace gigabake::kernels
