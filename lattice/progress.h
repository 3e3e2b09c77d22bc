/// How a long step says how far it is, and how it is stopped.
///
/// A function that may run for longer than a second takes a Progress as its last parameter. It names each step when the
/// step begins, and reports what is done about ten times a second. A caller who is not interested passes nothing.
#pragma once

#include <cstdint>
#include <exception>
#include <string>

namespace gigabake {

/// Thrown out of a long step that was asked to stop. Destructors have taken away what was half-written.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped before the end"; }
};

/// Whoever is told how far a step is. Several threads may call it at the same time.
class ProgressListener {
 public:
  virtual ~ProgressListener() = default;

  /// A step begins, and the one before it has ended. name: as a person reads it, "reading the tileset"; total: how many
  /// parts it has, 0 where nobody can know; unit: what one part is, "tile"; empty where a percentage says more.
  virtual void step(const std::string& name, std::uint64_t total, const std::string& unit) = 0;
  /// So many more parts are done; 0: none, but the step is still running. Errors  Stopped: the listener wants the step
  /// to end.
  virtual void advance(std::uint64_t parts) = 0;
};

/// Cost    Without a listener a comparison; the listeners of commands take some nanoseconds.
/// Errors  Stopped, of every member.
class Progress {
 public:
  /// Nobody listens, and nothing is ever stopped.
  Progress() = default;
  /// The listener outlives it and all its copies.
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
