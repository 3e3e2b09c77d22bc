/// Processes that write one export together.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace gigabake {

/// The base class is a team of one process. Every rank must call the same members in the same order, with the same
/// steps.
class ExportTeam {
 public:
  virtual ~ExportTeam() = default;

  virtual int rank() const { return 0; }
  virtual int ranks() const { return 1; }
  /// Runs `step` on every rank.
  /// Errors  Thrown on every rank if the step fails on one.
  virtual void together(const std::function<void()>& step) const { step(); }
  /// Returns every rank's bytes, by rank, on every rank.
  virtual std::vector<std::vector<std::uint8_t>> exchange(std::vector<std::uint8_t> own) const {
    return {std::move(own)};
  }
};

}  // namespace gigabake
