/// The start of a bake process's device while the process scans tiles, or even before it has its scene.
#pragma once

#include <functional>
#include <future>
#include <optional>
#include <thread>

#include "worker/pipeline/bake_messages.h"

namespace gigabake {

/// Creates the context of the device, if this process has none yet. Waits if a DeviceStart creates it. Thread-safe.
/// Errors  CudaFailure.
void start_device(int device);

/// The choice and the start of a device on a thread. The driver takes 0.1 s to list the devices and 0.15 s to create a
/// context. It serves one process of a host at a time, so processes of gigabake take turns for both: the first one
/// bakes while the others wait.
class DeviceStart {
 public:
  /// `on_chosen` is called on another thread after each choice.
  explicit DeviceStart(std::function<void()> on_chosen) : on_chosen_(std::move(on_chosen)) {}
  /// Waits for the thread.
  ~DeviceStart();
  DeviceStart(const DeviceStart&) = delete;
  DeviceStart& operator=(const DeviceStart&) = delete;

  /// Begins to choose and start the device, unless it was begun with an equal request. A different request replaces the
  /// earlier one.
  void begin(const DeviceRequest& request);
  bool is_chosen() const;
  /// Waits for the choice, and returns it. The start of the chosen device may still continue; the first use of the
  /// device waits for it, and reports its errors.
  /// Range   begin() was called.
  const DeviceAnswer& answer() const { return chosen_.get(); }

 private:
  void choose_and_start(const DeviceRequest& request, std::promise<DeviceAnswer>& chosen);

  std::function<void()> on_chosen_;
  std::optional<DeviceRequest> request_;
  std::shared_future<DeviceAnswer> chosen_;
  std::thread thread_;  ///< joins its predecessor, if there was another request
};

}  // namespace gigabake
