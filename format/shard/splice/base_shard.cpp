#include "format/shard/splice/base_shard.h"

#include "core/base/error.h"
#include "format/shard/packed_shard.h"
#include "format/shard/shard_header.h"
#include "format/shard/shard_layout.h"
#include "format/shard/shard_reader.h"

namespace gigabake {
namespace {

constexpr std::size_t of_voxels = 0, of_children = 1, of_facing = 2;
constexpr std::uint64_t bricks_per_part = 64 * bricks_per_start;

std::vector<std::uint8_t> all_bytes(const Hdf5Rows& rows) {
  std::vector<std::uint8_t> out(rows.rows());
  rows.read(0, rows.rows(), out.data());
  return out;
}

/// Appends masks and first voxels.
void append(const BrickLevel& part, BrickLevel& to) {
  const std::uint64_t voxels = to.first.back();
  to.mask.insert(to.mask.end(), part.mask.begin(), part.mask.end());
  for (std::size_t b = 1; b < part.first.size(); ++b) to.first.push_back(voxels + part.first[b]);
}

}  // namespace

std::size_t counted_by(LevelColumn column) {
  return column == LevelColumn::children ? of_children : column == LevelColumn::facing ? of_facing : of_voxels;
}

BaseShard::BaseShard(const std::filesystem::path& path, const ThreadPool& pool)
    : pages_(path), file_(Hdf5File::open(path)) {
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
  pool.parallel_for(lods(), 1, [this](std::size_t lod, std::size_t, int) { read_rows(lod); });
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

/// Counts alphas, and the rows of the column `facing`.
void BaseShard::read_rows(std::size_t lod) {
  BaseLevel& level = levels_[lod];
  for (const std::uint8_t alpha : all_bytes(*level.columns[std::size_t(LevelColumn::alpha)])) ++level.alphas[alpha];
  const Hdf5Rows* facing = level.columns[std::size_t(LevelColumn::facing)].get();
  if (facing == nullptr) return;
  const Hdf5Rows* stored = level.columns[std::size_t(LevelColumn::plane)].get();
  const std::vector<std::uint8_t> planes =
      stored != nullptr ? all_bytes(*stored) : std::vector<std::uint8_t>(level.bricks.first.back());
  for (std::size_t b = 0; b < level.key.size(); ++b) {
    std::uint64_t rows = level.before[b][of_facing];
    for (std::uint64_t v = level.bricks.first[b]; v < level.bricks.first[b + 1]; ++v)
      rows += stores_coverage(planes[v], false) ? 1 : 0;
    level.before[b + 1][of_facing] = rows;
  }
  if (level.before.back()[of_facing] != facing->rows()) is_spliceable_ = false;
}

}  // namespace gigabake
