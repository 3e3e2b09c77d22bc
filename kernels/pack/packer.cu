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

/// The columns of a cell, and the offset of each column in a common buffer.
class ColumnPlan {
 public:
  ColumnPlan(const LevelsView& view, const PackRequest& request, const Findings& found, std::uint32_t nodes,
             PackedCell& cell)
      : view_(view), found_(found), outs_(cell.levels.size()) {
    cell.nodes.resize(request.nodes.size());
    for (std::size_t c = 0; c < request.nodes.size(); ++c)
      nodes_.push_back(place(cell.nodes[c], nodes, request.nodes[c]));
    for (std::size_t lod = 0; lod < cell.levels.size(); ++lod)
      place_level(int(lod), request.levels[lod], cell.levels[lod]);
  }

  std::size_t bytes() const { return bytes_; }
  const std::vector<RawColumn>& columns() const { return columns_; }

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

  std::vector<LevelOut> outs(std::uint8_t* raw) const {
    std::vector<LevelOut> outs;
    for (std::size_t lod = 0; lod < outs_.size(); ++lod) {
      const Places& p = outs_[lod];
      const auto at = [&](LevelColumn column) { return raw + p.at[std::size_t(column)]; };
      outs.push_back({reinterpret_cast<std::uint64_t*>(at(LevelColumn::first)), at(LevelColumn::children),
                      at(LevelColumn::rgb), at(LevelColumn::alpha), at(LevelColumn::normal), at(LevelColumn::facing),
                      at(LevelColumn::plane), found_.children_begin[lod], found_.coverage_begin[lod],
                      found_.is_dense[lod] != 0, found_.is_complete[lod] != 0, p.has_plane});
    }
    return outs;
  }

 private:
  /// The offsets of a level's columns, by LevelColumn.
  struct Places {
    std::array<std::size_t, level_column_count> at = {};
    bool has_plane = false;
  };

  std::size_t place(PackedColumn& column, std::uint64_t rows, const RowShape& shape) {
    column.rows = rows;
    const std::size_t at = bytes_, bytes = chunk_count(rows, shape.bytes) * chunk_bytes(rows, shape.bytes);
    columns_.push_back({&column, shape, at, bytes});
    bytes_ += (bytes + alignment - 1) / alignment * alignment;
    return at;
  }

  void place_level(int lod, const std::vector<LevelColumn>& columns, PackedLevel& level) {
    std::copy(std::begin(found_.alphas[lod]), std::end(found_.alphas[lod]), level.alphas.begin());
    Places& places = outs_[std::size_t(lod)];
    for (const LevelColumn column : columns) {
      places.at[std::size_t(column)] = place(level[column], found_.rows(view_, column, lod), row_of(column));
      places.has_plane = places.has_plane || column == LevelColumn::plane;
    }
  }

  const LevelsView& view_;
  const Findings& found_;
  std::vector<std::size_t> nodes_;
  std::vector<Places> outs_;
  std::vector<RawColumn> columns_;
  std::size_t bytes_ = 0;
};

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
    const ColumnPlan plan(view, request, *found, nodes.count, out);
    DeviceArray<std::uint8_t> raw(heap_, plan.bytes());
    raw.clear_to_zero();
    make_columns(heap_, view, rows, plan.outs(raw.data()));
    make_node_columns(heap_, nodes, plan.nodes(raw.data()));
    const auto bring = request.as == ColumnBytes::stored ? read_back_stored : read_back_raw;
    out.memory = bring(heap_, raw, plan.columns(), pinned_);
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
