#include "worker/device/device_start.h"

#include <chrono>
#include <exception>
#include <fcntl.h>
#include <mutex>
#include <optional>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#include "core/base/error.h"
#include "core/base/trace.h"
#include "kernels/cuda/baker.h"

namespace gigabake {
namespace {

/// A lock of the host's NVIDIA driver among processes of gigabake. If it cannot be locked, no process waits.
class DriverLock {
 public:
  DriverLock() : fd_(::open("/proc/driver/nvidia", O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (fd_ >= 0) ::flock(fd_, LOCK_EX);
  }
  ~DriverLock() {
    if (fd_ >= 0) ::close(fd_);
  }
  DriverLock(const DriverLock&) = delete;
  DriverLock& operator=(const DriverLock&) = delete;

 private:
  int fd_;
};

DeviceAnswer choose(const DeviceRequest& request) {
  const TraceSpan span("choose device");
  DeviceAnswer answer;
  try {
    answer.choice = choose_device(request);
  } catch (const std::exception& e) {
    answer.error = e.what();
  }
  return answer;
}

std::mutex starting;

}  // namespace

void start_device(int device) {
  const std::scoped_lock lock(starting);
  kernels::start_device(device);
}

DeviceStart::~DeviceStart() {
  if (thread_.joinable()) thread_.join();
}

void DeviceStart::begin(const DeviceRequest& request) {
  if (request_ == request) return;
  request_ = request;
  std::promise<DeviceAnswer> promise;
  chosen_ = promise.get_future().share();
  thread_ = std::thread([this, request, promise = std::move(promise), earlier = std::move(thread_)]() mutable {
    if (earlier.joinable()) earlier.join();
    choose_and_start(request, promise);
  });
}

void DeviceStart::choose_and_start(const DeviceRequest& request, std::promise<DeviceAnswer>& chosen) {
  std::optional<DriverLock> lock;
  if (request.backend != Backend::cpu) lock.emplace();
  DeviceAnswer answer = choose(request);
  const std::optional<int> device = answer.choice.device;
  const std::scoped_lock start(starting);  // before the choice is known, so that no other thread starts the device
  chosen.set_value(std::move(answer));
  on_chosen_();
  if (!device) return;
  const TraceSpan span("start device");
  try {
    kernels::start_device(*device);
  } catch (const CudaFailure&) {
    return;  // the first use of the device meets the error, too, and reports it
  }
}

bool DeviceStart::is_chosen() const {
  return chosen_.valid() && chosen_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace gigabake
