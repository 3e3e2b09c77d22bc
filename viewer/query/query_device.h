/// The device that casts the rays of a SceneQuery, and the trees on it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "kernels/first_hit/query_device.h"
#include "viewer/query/query_places.h"
#include "viewer/query/query_tree.h"

namespace gigabake {

/// Trees are added until the device is full; none is evicted. Rays that need other trees pause.
class QueryDevice {
 public:
  struct Options {
    int device = 0;
    std::uint64_t device_bytes = 0;
    QueryLevels levels;
  };

  /// Lays out the cells.
  /// Errors  CudaFailure; InputError, as QueryPlaces::lay_out_all().
  QueryDevice(const Options& options, QueryPlaces& places, const ThreadPool& pool);

  /// Casts each ray until it is finished or pauses.
  /// Errors  CudaFailure.
  void cast(std::span<const QueryRay> rays, std::span<QueryTraversal> walks);
  /// Adds the tree of a cell's shard, unless the device has it or is full.
  /// Errors  CudaFailure.
  void add(std::uint32_t shard, const QueryTree& tree);
  bool is_full() const { return is_full_; }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> absent_;  ///< cells by shard; their trees are not on the device
  bool is_full_ = false;
  std::unique_ptr<kernels::CudaQuery> cuda_;
};

/// Returns why a device cannot cast rays of these levels; empty if it can. memory_bytes: bound of the cells' layout.
std::string device_limit(const QueryPlaces& places, const PagedScene& scene, const QueryLevels& levels,
                         std::uint64_t memory_bytes);

/// Returns the table of the places' cells in which no tree is resident. entries: receives the array that it borrows.
/// Range   after places.lay_out_all().
kernels::QueryCells query_cells(const QueryPlaces& places, std::vector<kernels::QueryCells::Entry>& entries);

}  // namespace gigabake
