/// Progress reports and cancellation of long steps.
///
/// A function that may run longer than a second takes a Progress as its last parameter. It names each step when the
/// step begins and reports progress about ten times a second. The default Progress reports nothing.
#pragma once

#include <cstdint>
#include <exception>
#include <string>

namespace gigabake {

/// The exception that ends a cancelled step. Destructors remove partial output.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped before the end"; }
};

/// A receiver of progress reports. Several threads may call it concurrently.
class ProgressListener {
 public:
  virtual ~ProgressListener() = default;

  /// Begins a step and ends the previous step. `name` is text for the user, "reading the tileset". `total` is the
  /// number of parts, 0 if unknown. `unit` is the noun of a part, "tile"; if it is empty, the user sees a percentage
  /// instead.
  virtual void step(const std::string& name, std::uint64_t total, const std::string& unit) = 0;
  /// Reports that `parts` more parts are done; 0 only shows that the step is running.
  /// Errors  Stopped if the listener cancels the step.
  virtual void advance(std::uint64_t parts) = 0;
};

/// A handle to an optional ProgressListener.
/// Cost    O(1): one comparison if there is no listener, some nanoseconds with the listeners of commands.
/// Errors  All members throw Stopped.
class Progress {
 public:
  /// Reports to no listener and never cancels.
  Progress() = default;
  /// Stores a reference: `listener` must outlive this object and all its copies.
  explicit Progress(ProgressListener& listener) : listener_(&listener) {}

  void step(const std::string& name, std::uint64_t total = 0, const std::string& unit = {}) const {
    if (listener_ == nullptr) return;
    listener_->step(name, total, unit);
    listener_->advance(0);
  }
  void advance(std::uint64_t parts = 1) const {
    if (listener_ != nullptr) listener_->advance(parts);
  }

 private:
  ProgressListener* listener_ = nullptr;
};

}  // namespace gigabake
