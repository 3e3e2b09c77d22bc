/// Rank 0's store of children's data that workers sent for overviews, until the overviews are dispatched.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "format/job/cell_job.h"
#include "worker/overview/child_bytes.h"

namespace gigabake {

/// The data of children that may be baked by another worker than the one that makes their overview.
/// Cost    Holds the data of children whose overviews wait, at most max_bytes; further data are dropped. Constant time
///         per child.
class SentChildren {
 public:
  /// `jobs` must outlive this object, and has all overviews after all cells.
  explicit SentChildren(const std::vector<CellJob>& jobs, std::uint64_t max_bytes = std::uint64_t(256) << 20);

  /// Stores what `worker` sent for a baked job. Empty `bytes` are not stored.
  void keep(int worker, const CellReport& report, std::vector<std::uint8_t> bytes);
  /// Returns the data of the overview's children that other workers than `worker` sent. A child's data are removed
  /// when its last overview takes them. A second attempt at an overview thus reads shards.
  std::vector<ChildBytes> take_for(std::uint32_t overview, int worker);

 private:
  struct Sent {
    int worker;
    ChildBytes child;
  };

  const std::vector<CellJob>& jobs_;
  std::vector<std::uint8_t> overviews_left_;  ///< per job: overviews that have not taken it
  std::unordered_map<std::uint32_t, Sent> sent_;
  const std::uint64_t max_bytes_;
  std::uint64_t bytes_ = 0;  ///< of all data in sent_
};

}  // namespace gigabake
