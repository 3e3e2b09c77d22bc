#include "query/query_device.h"

#include <bit>

#include "core/base/pluralize.h"

namespace gigabake {

using kernels::QueryCells;

QueryCells query_cells(const QueryPlaces& places, std::vector<QueryCells::Entry>& entries) {
  entries.assign(places.layout().cells.size(), {});
  for (std::size_t cell = 0; cell < entries.size(); ++cell)
    if (const std::optional<std::uint32_t> shard = places.shard_of_cell(cell))
      entries[cell] = {*shard, QueryCells::State::absent};
  QueryCells cells;
  cells.layout = places.layout().scene;
  cells.entries = {entries.data(), entries.size()};
  cells.has_pages = places.has_pages();
  return cells;
}

std::string device_limit(const QueryPlaces& places, const PagedScene& scene, const QueryLevels& levels,
                         std::uint64_t memory_bytes) {
  constexpr std::uint64_t bytes_per_cell = 1024;
  if (levels.spread > 0) return "a device casts no rays that widen";
  const int cell_lods = std::countr_zero(scene.totals().cell_voxels) - 2;
  if (places.has_pages() && levels.finest >= cell_lods) return "a device casts no rays through overviews";
  if (scene.totals().cells > memory_bytes / bytes_per_cell)
    return "the list of " + pluralize(scene.totals().cells, "cell") + " is larger than the memory";
  return {};
}

QueryDevice::QueryDevice(const Options& options, QueryPlaces& places, const ThreadPool& pool) {
  places.lay_out_all(pool);
  std::vector<QueryCells::Entry> entries;
  const QueryCells cells = query_cells(places, entries);
  for (std::uint32_t cell = 0; cell < entries.size(); ++cell)
    if (entries[cell].state == QueryCells::State::absent) absent_.emplace(entries[cell].shard, cell);
  cuda_ = std::make_unique<kernels::CudaQuery>(options.device, cells, options.levels, places.window(),
                                               options.device_bytes);
}

void QueryDevice::cast(std::span<const QueryRay> rays, std::span<QueryTraversal> walks) {
  cuda_->cast({rays.data(), rays.size()}, {walks.data(), walks.size()});
}

void QueryDevice::add(std::uint32_t shard, const QueryTree& tree) {
  const auto found = absent_.find(shard);
  if (is_full_ || found == absent_.end()) return;
  try {
    cuda_->add_tree(found->second, shard, tree.view());
    absent_.erase(found);
  } catch (const DeviceFull&) {
    is_full_ = true;
  }
}

}  // namespace gigabake
