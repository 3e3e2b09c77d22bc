#include "format/shard/shard_pages.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <future>
#include <optional>

#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/shard/check/shard_check.h"
#include "format/shard/check/shard_outline.h"
#include "format/shard/columns/channel_rows.h"
#include "format/shard/columns/predicted_level.h"
#include "format/shard/hdf5/hdf5_rows.h"
#include "format/shard/shard_header.h"
#include "format/shard/shard_layout.h"

namespace gigabake {
namespace {

/// The bricks of a coarser level that are decoded together, and the number of such blocks kept per level. A block takes
/// some 200 kB.
constexpr std::uint64_t bricks_at_once = 512;
constexpr std::size_t max_kept = 2;
static_assert(bricks_at_once % bricks_per_start == 0);

template <class T>
std::vector<T> read_range(const Hdf5Rows& column, std::uint64_t first, std::uint64_t count, std::size_t width = 1) {
  std::vector<T> out(count * width);
  column.read(first, count, out.data());
  return out;
}

template <class T>
std::vector<T> read_all(const Hdf5Rows& column) {
  return read_range<T>(column, 0, column.rows());
}

/// Returns the number of rows from `first` on, at most `count`, of a dataset that has `all` rows.
std::uint64_t clipped(const Hdf5File& file, const std::string& dataset, std::uint64_t first, std::uint64_t count,
                      std::uint64_t all) {
  if (first >= all)
    file.fail(dataset, "has " + pluralize(all, "row") + "; row " + std::to_string(first) + " was requested");
  return std::min(count, all - first);
}

}  // namespace

struct ShardPages::Nodes {
  Nodes(const Hdf5File& file, const ShardHeader& header, const NodeColumns& columns)
      : directional_coverage_column(columns.directional_coverage),
        kind(file, columns.kind),
        child_mask(file, columns.child_mask),
        first_child(file, columns.first_child),
        value(file, columns.value),
        normal(file, columns.normal),
        outline(file.path(), header, read_all<std::uint8_t>(Hdf5Rows(file, columns.lod)), read_all<NodeKind>(kind),
                read_all<std::uint8_t>(child_mask),
                header.leaf_lod == 0 ? std::vector<std::uint8_t>()
                                     : read_all<std::uint8_t>(Hdf5Rows(file, columns.leaf_mask))) {
    if (header.leaf_lod != 0) leaf_mask.emplace(file, columns.leaf_mask);
    for (const Hdf5Rows* column : {&first_child, &value, &normal})
      if (column->rows() != outline.rows()) file.fail("/nodes", "columns differ in length");
    if (header.has_directional_coverage) directional_coverage.emplace(file, columns.directional_coverage);
    if (header.has_classes) voxel_class.emplace(file, columns.voxel_class);
    for (const auto* column : {&directional_coverage, &voxel_class})
      if (*column && (*column)->rows() != outline.rows()) file.fail("/nodes", "columns differ in length");
  }

  Hdf5Column directional_coverage_column;
  Hdf5Rows kind, child_mask, first_child, value, normal;
  std::optional<Hdf5Rows> directional_coverage, leaf_mask, voxel_class;
  ShardOutline outline;
};

/// A level of versions 1 to 6.
struct ShardPages::ValueLevel {
  ValueLevel(const FileColumns& source, const Hdf5File& file, const std::vector<VoxelChannel>& of_voxels,
             const LevelColumns& columns, std::uint64_t bricks)
      : mask(file, columns.mask), first(file, columns.first) {
    if (mask.rows() != bricks) file.fail(columns.group, "the number of bricks differs from the nodes of this level");
    if (first.rows() != bricks + 1) file.fail(columns.group, "first does not match mask");
    voxels = read_range<std::uint64_t>(first, bricks, 1)[0];
    for (const VoxelChannel& channel : of_voxels) channels.emplace_back(source, columns.group, channel, bricks, voxels);
  }

  std::uint64_t voxels = 0;
  Hdf5Rows mask, first;
  std::deque<ChannelRows> channels;
};

/// Bricks [begin, end) of a level. Other threads wait for the thread that decodes them.
struct ShardPages::DecodedBricks {
  std::uint64_t begin, end;
  std::shared_future<BrickLevel> level;
};

struct ShardPages::Level {
  Level(const Hdf5File& file, std::uint64_t bricks_of_nodes) : source(file), bricks(bricks_of_nodes) {}

  FileColumns source;
  std::uint64_t bricks;
  std::optional<ValueLevel> values;
  std::optional<PredictedLevel> predicted;  ///< since version 7
  /// The last bricks that finer levels needed, the latest first. Guarded by mutex_.
  mutable std::vector<DecodedBricks> decoded;
};

ShardPages::ShardPages(const std::filesystem::path& path, std::shared_ptr<ChunkCache> chunks)
    : file_(Hdf5File::open(path, ChunkPlaces::by_table, std::move(chunks))),
      header_(read_header(file_)),
      version_(read_version(file_)),
      levels_(header_.lods) {}

ShardPages::~ShardPages() = default;

const ShardPages::Nodes& ShardPages::open_nodes() const {
  const std::scoped_lock lock(mutex_);
  if (!nodes_) nodes_ = std::make_unique<Nodes>(file_, header_, NodeColumns(version_));
  return *nodes_;
}

const ShardPages::Level& ShardPages::open_level(int lod) const {
  if (lod < 0 || std::uint32_t(lod) >= header_.lods) file_.fail(level_group(lod), "the cell has no such level");
  const std::uint64_t bricks = open_nodes().outline.bricks(lod);
  const std::scoped_lock lock(mutex_);
  std::unique_ptr<Level>& level = levels_[std::size_t(lod)];
  if (level) return *level;
  auto opened = std::make_unique<Level>(file_, bricks);
  if (version_ < first_version_of_differences)
    opened->values.emplace(opened->source, file_, stored_channels(version_, header_, lod), LevelColumns(lod), bricks);
  else
    opened->predicted.emplace(opened->source, header_, lod, bricks);
  level = std::move(opened);
  return *level;
}

std::uint64_t ShardPages::node_rows() const { return open_nodes().outline.rows(); }

std::uint64_t ShardPages::bricks(int lod) const { return open_level(lod).bricks; }

std::vector<NodeRow> ShardPages::nodes(std::uint64_t first, std::uint32_t count) const {
  const Nodes& columns = open_nodes();
  const std::uint64_t rows = clipped(file_, "/nodes", first, count, columns.outline.rows());
  NodeWalk walk(file_.path(), header_, columns.outline.place_before(first), columns.outline.rows());
  const std::uint64_t begin = walk.place().row;
  const auto kind = read_range<NodeKind>(columns.kind, begin, first + rows - begin);
  const auto child_mask = read_range<std::uint8_t>(columns.child_mask, begin, first + rows - begin);
  const auto leaf_mask = columns.leaf_mask ? read_range<std::uint8_t>(*columns.leaf_mask, begin, first + rows - begin)
                                           : std::vector<std::uint8_t>(first + rows - begin);
  const auto first_child = read_range<std::uint32_t>(columns.first_child, first, rows);
  const auto value = read_range<std::uint32_t>(columns.value, first, rows);
  const auto normal = read_range<std::int8_t>(columns.normal, first, rows, 2);
  const auto directional_coverage =
      columns.directional_coverage
          ? directional_coverage_of_rows(read_range<std::uint8_t>(*columns.directional_coverage, first, rows,
                                                                  columns.directional_coverage_column.row_bytes()),
                                         columns.directional_coverage_column)
          : std::vector<DirectionalCoverage>(rows);
  const auto voxel_class = columns.voxel_class ? read_range<VoxelClass>(*columns.voxel_class, first, rows)
                                               : std::vector<VoxelClass>(rows, no_class);
  check_planes_of_nodes(file_.path(), first, directional_coverage);
  std::vector<NodeRow> out(rows);
  for (std::size_t i = 0; i < kind.size(); ++i) {
    if (begin + i >= first) {
      const std::size_t to = begin + i - first;
      walk.check_links(kind[i], child_mask[i], first_child[to], value[to]);
      out[to] = {first_child[to], value[to],      {normal[2 * to], normal[2 * to + 1]}, {}, kind[i], child_mask[i],
                 leaf_mask[i],    voxel_class[to]};
      std::copy_n(directional_coverage[to].begin(), directional_coverage_bytes, out[to].directional_coverage);
    }
    walk.step(walk.place().lod, kind[i], child_mask[i], leaf_mask[i]);
  }
  return out;
}

BrickBlock ShardPages::level(int lod, std::uint64_t first, std::uint32_t count) const {
  const Level& level = open_level(lod);
  const std::uint64_t bricks = clipped(file_, level_group(lod), first, std::min(count, max_bricks), level.bricks);
  return level.values ? read_values(lod, first, bricks) : cut_out(lod, first, bricks);
}

BrickBlock ShardPages::read_values(int lod, std::uint64_t first, std::uint64_t bricks) const {
  const ValueLevel& columns = *open_level(lod).values;
  BrickBlock block;
  block.mask = read_range<std::uint64_t>(columns.mask, first, bricks, 8);
  const auto starts = read_range<std::uint64_t>(columns.first, first, bricks + 1);
  check_bricks(file_.path(), lod, first, block.mask, starts);
  const std::uint64_t begin = starts.front(), voxels = starts.back() - begin;
  const BrokenRule table{file_.path(), level_group(lod)};
  table.expect(first > 0 || begin == 0, 0, "first does not begin at 0");
  table.expect(begin <= columns.voxels && voxels <= columns.voxels - begin, first,
               "first exceeds the number of voxels");
  block.first.reserve(starts.size());
  for (const std::uint64_t start : starts) block.first.push_back(std::uint32_t(start - begin));
  for (const ChannelRows& channel : columns.channels)
    channel.read(first, block.mask, begin, voxels, resize_channel(channel.channel(), voxels, block));
  check_coverage(file_.path(), lod, begin, block.rgba);
  check_planes(file_.path(), lod, begin, block.directional_coverage);
  return block;
}

/// Returns bricks of a level since version 7. Decodes also the bricks before them whose starts are not stored.
BrickBlock ShardPages::cut_out(int lod, std::uint64_t first, std::uint64_t bricks) const {
  const std::uint64_t skipped = first % bricks_per_start;
  BrickLevel level = decode(lod, first - skipped, skipped + bricks, PredictedLevel::Values::all);
  const std::uint64_t before = level.first[skipped];
  const auto cut = [](auto& from, std::uint64_t count) {
    from.erase(from.begin(), from.begin() + std::ptrdiff_t(std::min<std::size_t>(count, from.size())));
  };
  BrickBlock block;
  for (std::size_t b = skipped; b < level.first.size(); ++b)
    block.first.push_back(std::uint32_t(level.first[b] - before));
  cut(level.mask, brick_edge * skipped);
  cut(level.rgba, 4 * before);
  cut(level.normal, 2 * before);
  cut(level.directional_coverage, directional_coverage_bytes * before);
  cut(level.voxel_class, before);
  block.mask = std::move(level.mask);
  block.rgba = std::move(level.rgba);
  block.normal = std::move(level.normal);
  block.directional_coverage = std::move(level.directional_coverage);
  block.voxel_class = std::move(level.voxel_class);
  return block;
}

/// Returns bricks of a level since version 7.
/// Range   `begin` is a multiple of bricks_per_start.
BrickLevel ShardPages::decode(int lod, std::uint64_t begin, std::uint64_t count, PredictedLevel::Values values) const {
  const Level& level = open_level(lod);
  std::vector<BrickParent> parents = open_nodes().outline.parents(lod, begin, count);
  std::uint64_t low = ~std::uint64_t(0), end = 0;
  for (BrickParent& parent : parents) {
    if (parent.kind == BrickParent::constant) {
      const NodeRow row = nodes(parent.value, 1)[0];
      parent.value = row.value;
      parent.normal = std::uint16_t(std::uint8_t(row.normal[0]) | std::uint8_t(row.normal[1]) << 8);
    } else if (parent.kind == BrickParent::brick) {
      low = std::min<std::uint64_t>(low, parent.value);
      end = std::max<std::uint64_t>(end, parent.value + std::uint64_t(1));
    }
  }
  if (end == 0) return level.predicted->read(begin, parents, {}, values);
  const DecodedBricks above = decoded(lod + 1, low, end);
  return level.predicted->read(begin, parents, {&above.level.get(), above.begin}, values);
}

/// Returns at least bricks [low, end) of a level since version 7, without alphas and planes. Keeps the last of them,
/// because requests for finer bricks often have parents near each other. A thread waits only for a thread that decodes
/// a coarser level than its own.
ShardPages::DecodedBricks ShardPages::decoded(int lod, std::uint64_t low, std::uint64_t end) const {
  const Level& level = open_level(lod);
  std::vector<DecodedBricks>& kept = level.decoded;
  std::unique_lock lock(mutex_);
  for (const DecodedBricks& one : kept)
    if (one.begin <= low && end <= one.end) return one;
  std::promise<BrickLevel> promise;
  DecodedBricks bricks{low - low % bricks_at_once,
                       std::min(level.bricks, (end + bricks_at_once - 1) / bricks_at_once * bricks_at_once),
                       promise.get_future().share()};
  kept.insert(kept.begin(), bricks);
  if (kept.size() > max_kept) kept.pop_back();
  lock.unlock();
  try {
    promise.set_value(decode(lod, bricks.begin, bricks.end - bricks.begin, PredictedLevel::Values::predictions));
  } catch (...) {
    promise.set_exception(std::current_exception());
    lock.lock();
    std::erase_if(kept, [&](const DecodedBricks& one) { return one.begin == bricks.begin && one.end == bricks.end; });
  }
  return bricks;
}

}  // namespace gigabake
