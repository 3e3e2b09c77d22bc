#include "format/shard/splice/base_shard.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "core/base/error.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard_header.h"
#include "format/shard/shard_layout.h"
#include "format/shard/shard_reader.h"

namespace gigabake {
namespace {

constexpr std::uint64_t bricks_per_part = 64 * bricks_per_start;

/// Calls visit(chunk, first row, bytes, thread) for each chunk of a column of bytes.
template <class Visit>
void for_each_chunk(const Hdf5Rows& rows, const ThreadPool& pool, const Visit& visit) {
  if (rows.rows() == 0) return;
  const std::uint64_t per_chunk = rows.chunk_rows();
  pool.parallel_for((rows.rows() + per_chunk - 1) / per_chunk, 1, [&](std::size_t chunk, std::size_t, int thread) {
    const std::uint64_t first = chunk * per_chunk;
    std::vector<std::uint8_t> bytes(std::min(per_chunk, rows.rows() - first));
    rows.read(first, bytes.size(), bytes.data());
    visit(chunk, first, std::span<const std::uint8_t>(bytes), thread);
  });
}

AlphaCounts alphas_of(const Hdf5Rows& rows, const ThreadPool& pool) {
  std::vector<AlphaCounts> of_thread(std::size_t(pool.threads()));
  for_each_chunk(rows, pool, [&](std::size_t, std::uint64_t, std::span<const std::uint8_t> bytes, int thread) {
    for (const std::uint8_t alpha : bytes) ++of_thread[std::size_t(thread)][alpha];
  });
  AlphaCounts all{};
  for (const AlphaCounts& some : of_thread)
    for (std::size_t alpha = 0; alpha < all.size(); ++alpha) all[alpha] += some[alpha];
  return all;
}

/// Returns for each position the number of voxels before it that store coverages.
/// Range   `positions` is ascending. The last one is the number of rows.
std::vector<std::uint64_t> coverages_before(const Hdf5Rows& planes, std::span<const std::uint64_t> positions,
                                            const ThreadPool& pool) {
  std::vector<std::uint64_t> before(positions.size()), of_chunk(1);
  if (planes.rows() == 0) return before;
  of_chunk.resize(1 + (planes.rows() + planes.chunk_rows() - 1) / planes.chunk_rows());
  for_each_chunk(planes, pool, [&](std::size_t chunk, std::uint64_t first, std::span<const std::uint8_t> bytes, int) {
    auto at = std::size_t(std::ranges::lower_bound(positions, first) - positions.begin());
    std::uint64_t count = 0;
    for (std::size_t v = 0; v < bytes.size(); ++v) {
      for (; positions[at] == first + v; ++at) before[at] = count;
      count += stores_coverage(bytes[v], false) ? 1 : 0;
    }
    of_chunk[chunk + 1] = count;
  });
  std::partial_sum(of_chunk.begin(), of_chunk.end(), of_chunk.begin());
  for (std::size_t at = 0; at < positions.size(); ++at)
    before[at] =
        positions[at] == planes.rows() ? of_chunk.back() : before[at] + of_chunk[positions[at] / planes.chunk_rows()];
  return before;
}

/// Appends masks and first voxels.
void append(const BrickLevel& part, BrickLevel& to) {
  const std::uint64_t voxels = to.first.back();
  to.mask.insert(to.mask.end(), part.mask.begin(), part.mask.end());
  for (std::size_t b = 1; b < part.first.size(); ++b) to.first.push_back(voxels + part.first[b]);
}

}  // namespace

BaseShard::BaseShard(const std::filesystem::path& path, const ThreadPool& pool)
    : pages_(path), file_(Hdf5File::open(path, ChunkPlaces::by_index)) {
  if (const std::int32_t version = read_version(file_);
      version != first_version_of_differences && version != first_version_of_classes)
    throw InputError(path, "version", "is not the current version, of which edits take bricks");
  const ShardReader reader(path);
  nodes_ = reader.nodes();
  above_ = reader.above();
  levels_.resize(header().lods);
  for (std::size_t n = 0; n < nodes_.key.size(); ++n)
    if (nodes_.kind[n] == NodeKind::brick) levels_[nodes_.lod[n]].key.push_back(nodes_.key[n]);
  for (std::size_t lod = 0; lod < lods(); ++lod)
    for (const LevelColumn column : level_columns(header(), int(lod)))
      levels_[lod].columns[std::size_t(column)] = std::make_unique<Hdf5Rows>(file_, level_column(int(lod), column));
  read_masks(pool);
  for (std::size_t lod = 0; lod < lods(); ++lod) read_rows(int(lod), pool);
}

/// Decodes the masks of all levels, from the coarsest.
void BaseShard::read_masks(const ThreadPool& pool) {
  std::vector<std::size_t> bricks;
  for (const BaseLevel& level : levels_) bricks.push_back(level.key.size());
  const std::vector<std::vector<BrickParent>> parents = brick_parents(nodes_, bricks);
  const FileColumns source(file_);
  for (std::size_t lod = lods(); lod-- > 0;) {
    BaseLevel& level = levels_[lod];
    const PredictedLevel stored(source, header(), int(lod), bricks[lod]);
    const SomeBricks above{lod + 1 < lods() ? &levels_[lod + 1].bricks : nullptr, 0};
    std::vector<BrickLevel> parts((bricks[lod] + bricks_per_part - 1) / bricks_per_part);
    pool.parallel_for(parts.size(), 1, [&](std::size_t p, std::size_t, int) {
      const std::uint64_t begin = p * bricks_per_part, end = std::min(begin + bricks_per_part, bricks[lod]);
      parts[p] =
          stored.read(begin, std::span(parents[lod]).subspan(begin, end - begin), above, PredictedLevel::Values::masks);
    });
    level.bricks.first = {0};
    for (const BrickLevel& part : parts) append(part, level.bricks);
    level.before.resize(bricks[lod] + 1);
    for (std::size_t b = 0; b < bricks[lod]; ++b)
      level.before[b + 1] = {level.bricks.first[b + 1],
                             level.before[b][of_children] +
                                 children_rows(parents[lod][b].kind, groups_with_parent(parents[lod][b], above), false),
                             0};
    is_spliceable_ &= level.before.back()[of_children] == level.columns[std::size_t(LevelColumn::children)]->rows();
  }
}

/// Counts alphas, and the rows of the column `facing`. Checks the columns that have a row per voxel.
void BaseShard::read_rows(int lod, const ThreadPool& pool) {
  BaseLevel& level = levels_[std::size_t(lod)];
  for (std::size_t c = 0; c < level.columns.size(); ++c) {
    const auto column = LevelColumn(c);
    if (level.columns[c] != nullptr && column != LevelColumn::first && counted_by(column) == of_voxels &&
        level.columns[c]->rows() != level.bricks.first.back())
      file_.fail(level_column(lod, column).name, "does not match first");
  }
  level.alphas = alphas_of(*level.columns[std::size_t(LevelColumn::alpha)], pool);
  const Hdf5Rows* facing = level.columns[std::size_t(LevelColumn::facing)].get();
  if (facing == nullptr) return;
  const Hdf5Rows* planes = level.columns[std::size_t(LevelColumn::plane)].get();
  const std::vector<std::uint64_t>& first = level.bricks.first;
  const std::vector<std::uint64_t> before = planes != nullptr ? coverages_before(*planes, first, pool) : first;
  for (std::size_t b = 0; b < before.size(); ++b) level.before[b][of_facing] = before[b];
  if (level.before.back()[of_facing] != facing->rows()) is_spliceable_ = false;
}

}  // namespace gigabake
