#include <algorithm>
#include <array>

#include "core/base/trace.h"
#include "core/codec/chunk_rows.h"
#include "kernels/body/prune/node.h"
#include "kernels/cuda/cell.cuh"
#include "kernels/cuda/device/clock.cuh"
#include "kernels/cuda/device/stream.cuh"
#include "kernels/cuda/mip/hash.cuh"
#include "kernels/cuda/prune/prune.cuh"
#include "kernels/pack/column_bytes.cuh"
#include "kernels/pack/columns.cuh"
#include "kernels/pack/packer.h"

namespace gigabake::kernels {
namespace {

constexpr std::size_t alignment = 256;

/// Returns the size of all chunks of a column.
std::size_t column_bytes(std::uint64_t rows, const RowShape& shape) {
  return chunk_count(rows, shape.bytes) * chunk_bytes(rows, shape.bytes);
}

/// Columns of a cell that are in device memory at the same time, one after another in a buffer.
class ColumnGroup {
 public:
  explicit ColumnGroup(std::size_t levels) : levels_(levels) {
    for (auto& places : levels_) places.fill(absent);
  }

  void add_node_column(PackedColumn& column, std::uint64_t rows, const RowShape& shape) {
    nodes_.push_back(place(column, rows, shape));
  }
  void add_level_column(std::size_t lod, LevelColumn number, PackedColumn& column, std::uint64_t rows) {
    levels_[lod][std::size_t(number)] = place(column, rows, row_of(number));
  }

  std::size_t bytes() const { return bytes_; }
  const std::vector<RawColumn>& columns() const { return columns_; }
  bool has_nodes() const { return !nodes_.empty(); }

  NodesOut nodes(std::uint8_t* raw) const {
    const auto of = [&]<class T>(NodeColumn column, T*) {
      const auto number = std::size_t(column);
      return number < nodes_.size() ? reinterpret_cast<T*>(raw + nodes_[number]) : nullptr;
    };
    NodesOut out{};
    out.key = of(NodeColumn::key, out.key);
    out.first_child = of(NodeColumn::first_child, out.first_child);
    out.value = of(NodeColumn::value, out.value);
    out.lod = of(NodeColumn::lod, out.lod);
    out.child_mask = of(NodeColumn::child_mask, out.child_mask);
    out.kind = of(NodeColumn::kind, out.kind);
    out.normal = of(NodeColumn::normal, out.normal);
    out.directional_coverage = of(NodeColumn::directional_coverage, out.directional_coverage);
    return out;
  }

  std::vector<LevelOut> outs(const Findings& found, std::uint8_t* raw) const {
    std::vector<LevelOut> outs;
    for (std::size_t lod = 0; lod < levels_.size(); ++lod) {
      const auto at = [&](LevelColumn column) {
        const std::size_t place = levels_[lod][std::size_t(column)];
        return place == absent ? nullptr : raw + place;
      };
      outs.push_back({reinterpret_cast<std::uint64_t*>(at(LevelColumn::first)), at(LevelColumn::children),
                      at(LevelColumn::rgb), at(LevelColumn::alpha), at(LevelColumn::normal), at(LevelColumn::facing),
                      at(LevelColumn::plane), found.children_begin[lod], found.coverage_begin[lod],
                      found.is_dense[lod] != 0, found.is_complete[lod] != 0});
    }
    return outs;
  }

 private:
  static constexpr std::size_t absent = ~std::size_t(0);

  std::size_t place(PackedColumn& column, std::uint64_t rows, const RowShape& shape) {
    column.rows = rows;
    const std::size_t at = bytes_, bytes = column_bytes(rows, shape);
    columns_.push_back({&column, shape, at, bytes});
    bytes_ += (bytes + alignment - 1) / alignment * alignment;
    return at;
  }

  std::vector<std::size_t> nodes_;
  std::vector<std::array<std::size_t, level_column_count>> levels_;  ///< [lod], by LevelColumn
  std::vector<RawColumn> columns_;
  std::size_t bytes_ = 0;
};

/// Divides the columns into groups of at most `max_bytes` bytes or one column. The first group has the node table.
std::vector<ColumnGroup> group_columns(const LevelsView& view, const PackRequest& request, const Findings& found,
                                       std::uint32_t nodes, std::uint64_t max_bytes, PackedCell& cell) {
  std::vector<ColumnGroup> groups{ColumnGroup(cell.levels.size())};
  cell.nodes.resize(request.nodes.size());
  for (std::size_t c = 0; c < request.nodes.size(); ++c)
    groups[0].add_node_column(cell.nodes[c], nodes, request.nodes[c]);
  for (std::size_t lod = 0; lod < cell.levels.size(); ++lod) {
    PackedLevel& level = cell.levels[lod];
    std::copy(std::begin(found.alphas[lod]), std::end(found.alphas[lod]), level.alphas.begin());
    for (const LevelColumn column : request.levels[lod]) {
      const std::uint64_t rows = found.rows(view, column, int(lod));
      if (groups.back().bytes() + column_bytes(rows, row_of(column)) > max_bytes && groups.back().bytes() != 0)
        groups.emplace_back(cell.levels.size());
      groups.back().add_level_column(lod, column, level[column], rows);
    }
  }
  return groups;
}

}  // namespace

class CudaPacker::Impl {
 public:
  explicit Impl(int device)
      : device_(device), stream_(device), clock_(stream_.handle), heap_(stream_.handle, memory_stats_) {}

  std::optional<PackedCell> pack(const BakedCell& cell, const PackRequest& request) {
    if (cell.levels.empty()) return std::nullopt;
    check_cuda(cudaSetDevice(device_), "cudaSetDevice");
    heap_.limit_to(request.memory_bytes);
    PackedCell out;
    out.stats = cell.cell_stats;
    out.above = cell.above;
    clock_.mark(0);
    const TraceSpan span("pack");
    out.content_hash = level_hashes(heap_, cell.levels, cell.window_min);
    clock_.mark(1);
    if (cell.nodes.count != 0) {
      std::vector<const DeviceLevel*> levels;
      for (const DeviceLevel& level : cell.levels) levels.push_back(&level);
      pack_levels(levels, cell.nodes, request, out);
    } else {
      const PrunedLevels pruned = prune_levels(heap_, cell.levels);
      if (pruned.has_constants) out.constants = constants_of(pruned.nodes);
      pack_levels(pruned.levels, pruned.nodes, request, out);
    }
    out.stats.hash_s = clock_.between(0, 1);
    return out;
  }

 private:
  void pack_levels(const std::vector<const DeviceLevel*>& levels, const DeviceNodes& nodes, const PackRequest& request,
                   PackedCell& out) {
    const LevelsView view = view_of(levels, request.levels);
    const auto found = std::make_unique<Findings>();
    const BrickRows rows = count_rows(heap_, view, nodes, *found);
    out.levels.resize(levels.size());
    // Compressed columns take as much memory as raw ones, and a batch of chunks takes the last third.
    const std::uint64_t max_bytes =
        request.as == ColumnBytes::stored ? heap_.available() / 3 : heap_.available() / 4 * 3;
    std::vector<std::shared_ptr<const void>> memory;
    for (const ColumnGroup& group : group_columns(view, request, *found, nodes.count, max_bytes, out))
      memory.push_back(pack_group(group, view, rows, *found, nodes, request.as));
    out.memory = std::make_shared<const std::vector<std::shared_ptr<const void>>>(std::move(memory));
  }

  /// Makes the columns of a group and transfers them. Returns the memory that they borrow.
  std::shared_ptr<const void> pack_group(const ColumnGroup& group, const LevelsView& view, const BrickRows& rows,
                                         const Findings& found, const DeviceNodes& nodes, ColumnBytes as) {
    DeviceArray<std::uint8_t> raw(heap_, group.bytes());
    raw.clear_to_zero();
    make_columns(heap_, view, rows, group.outs(found, raw.data()));
    if (group.has_nodes()) make_node_columns(heap_, nodes, group.nodes(raw.data()));
    const auto bring = as == ColumnBytes::stored ? read_back_stored : read_back_raw;
    return bring(heap_, raw, group.columns(), pinned_);
  }

  NodeTable constants_of(const DeviceNodes& nodes) {
    NodeTable all, constants;
    const auto bring = [&](const auto& from, auto& to) {
      to.resize(nodes.count);
      heap_.bring(to.data(), from.data(), from.bytes(), "constant nodes");
    };
    bring(nodes.kind, all.kind), bring(nodes.lod, all.lod), bring(nodes.value, all.value);
    for (std::size_t n = 0; n < nodes.count; ++n) {
      if (stores_voxels(all.kind[n])) continue;
      constants.kind.push_back(all.kind[n]);
      constants.lod.push_back(all.lod[n]);
      constants.value.push_back(all.value[n]);
    }
    return constants;
  }

  int device_;
  Stream stream_;
  StreamClock clock_;
  DeviceMemoryStats memory_stats_;
  DeviceHeap heap_;
  PinnedPool pinned_;
};

CudaPacker::CudaPacker(int device) : impl_(std::make_unique<Impl>(device)) {}
CudaPacker::~CudaPacker() = default;

std::optional<PackedCell> CudaPacker::pack(const CudaVolume& volume, const PackRequest& request) {
  return impl_->pack(static_cast<const BakedCell&>(volume), request);
}

}  // namespace gigabake::kernels
