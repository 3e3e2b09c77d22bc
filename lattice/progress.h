/// How a long step says how far it is, and how it is stopped.
///
/// Whatever may take longer than a second takes a Progress as its last parameter, begins its steps and says what is
/// done at least some ten times a second. Whoever is not interested passes nothing.
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

/// Who is told. Called by several threads at a time.
class ProgressListener {
 public:
  virtual ~ProgressListener() = default;

  /// The step before has ended. name: as a person reads it, "reading the tileset"; total: of its parts, 0 where nobody
  /// can know; unit: of the parts, in the plural, empty where a share of the total says more.
  virtual void step(const std::string& name, std::uint64_t total, const std::string& unit) = 0;
  /// So many more parts are done; 0: the step is still at it. Errors  Stopped: by the wish of whoever listens.
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
