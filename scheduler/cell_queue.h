/// The order of work: the largest cells first, and among cells of about that size the one nearest to what a worker has
/// just read, so that its tiles are still in the cache.
#pragma once

#include <optional>
#include <vector>

#include "format/cell_job.h"

namespace gigabake {

/// A value: the same calls give the same answers.
class CellQueue {
 public:
  explicit CellQueue(const std::vector<CellJob>& jobs);

  /// Takes the next job's index; nothing when all are taken. last: the index that this worker took before.
  std::optional<std::uint32_t> next(std::optional<std::uint32_t> last);
  std::size_t waiting() const { return order_.size(); }

 private:
  double distance(std::uint32_t a, std::uint32_t b) const;

  const std::vector<CellJob>& jobs_;  ///< outlives the queue
  std::vector<std::uint32_t> order_;  ///< smallest first: the end is next
};

}  // namespace gigabake
