/// Parents that were never handed out: which of them wait for children, and which are ready.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "format/job/cell_job.h"

namespace gigabake {

/// Exact  A value: the same calls give the same answers.
/// Cost   8 bytes a job and child; a call looks at the parents of one job, or at those that are ready.
class ParentQueue {
 public:
  /// jobs: parents after all cells.
  explicit ParentQueue(const std::vector<CellJob>& jobs);

  /// The job is done or set aside; call once for each. worker: who finished it, if one did.
  void settled(std::uint32_t job, std::optional<int> worker);
  /// One that is ready, until take(): rather one whose last child this worker finished.
  std::optional<std::uint32_t> choose(int worker) const;
  /// Handed out, or done already, ready or not.
  void take(std::uint32_t parent);
  /// Those that wait for children.
  std::size_t waiting() const { return waiting_; }

 private:
  struct Ready {
    std::uint32_t parent;
    std::optional<int> worker;
  };
  static constexpr std::uint32_t taken = 0xffffffffu;

  std::uint32_t first_parent_;
  std::vector<std::uint32_t> missing_;                  ///< by parent: children that are not settled; or taken
  std::vector<std::uint32_t> parents_begin_, parents_;  ///< by job: from where on its parents stand
  std::vector<Ready> ready_;                            ///< in the order in which they became so
  std::size_t waiting_ = 0;
};

}  // namespace gigabake
