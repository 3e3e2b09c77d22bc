#include <algorithm>

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
      place_level(int(lod), request.channels[lod], cell.levels[lod]);
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
    std::vector<LevelOut> outs(outs_.size());
    for (std::size_t lod = 0; lod < outs.size(); ++lod) {
      const Places& p = outs_[lod];
      outs[lod].mask = reinterpret_cast<std::uint64_t*>(raw + p.mask);
      outs[lod].first = reinterpret_cast<std::uint64_t*>(raw + p.first);
      for (std::size_t c = 0; c < p.channel.size(); ++c)
        outs[lod].channel[c] = {p.channel[c].stored, raw + p.channel[c].value, raw + p.channel[c].share,
                                reinterpret_cast<std::uint64_t*>(raw + p.channel[c].first), found_.begin[c][lod]};
    }
    return outs;
  }

 private:
  struct Places {
    std::size_t mask, first;
    struct Channel {
      ValuesStored stored;
      std::size_t value = 0, share = 0, first = 0;
    };
    std::vector<Channel> channel;
  };

  std::size_t place(PackedColumn& column, std::uint64_t rows, const RowShape& shape) {
    column.rows = rows;
    const std::size_t at = bytes_, bytes = chunk_count(rows, shape.bytes) * chunk_bytes(rows, shape.bytes);
    columns_.push_back({&column, shape, at, bytes});
    bytes_ += (bytes + alignment - 1) / alignment * alignment;
    return at;
  }

  void place_level(int lod, const std::vector<ChannelPlace>& channels, PackedLevel& level) {
    const std::uint64_t bricks = view_.bricks[lod];
    std::copy(std::begin(found_.alphas[lod]), std::end(found_.alphas[lod]), level.alphas.begin());
    level.channels.resize(channels.size());
    Places& places = outs_[std::size_t(lod)];
    places.mask = place(level.mask, bricks, mask_row);
    places.first = place(level.first, bricks + 1, first_row);
    for (std::size_t c = 0; c < channels.size(); ++c)
      places.channel.push_back(place_channel(lod, int(c), channels[c].width, level.channels[c]));
  }

  Places::Channel place_channel(int lod, int channel, std::size_t width, PackedChannel& packed) {
    Places::Channel places{found_.stored(view_, channel, lod)};
    const std::uint64_t bricks = view_.bricks[lod],
                        values = values_stored(places.stored, view_.voxels[lod], found_.values[channel][lod]);
    places.value = place(packed.value, values, {width, 1});
    if (places.stored != ValuesStored::shared) return places;
    places.share = place(packed.share, bricks, share_row);
    places.first = place(packed.first, bricks + 1, first_row);
    return places;
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
    const LevelsView view = view_of(levels, request.channels);
    const auto found = std::make_unique<Findings>();
    const FoundShares shares = find_shares(heap_, view, *found);
    out.levels.resize(levels.size());
    const ColumnPlan plan(view, request, *found, nodes.count, out);
    DeviceArray<std::uint8_t> raw(heap_, plan.bytes());
    raw.clear_to_zero();
    make_columns(heap_, view, shares, plan.outs(raw.data()));
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
