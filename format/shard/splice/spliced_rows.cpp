#include "format/shard/splice/spliced_rows.h"

#include <algorithm>
#include <cstring>

#include "core/codec/chunk_rows.h"

namespace gigabake {

SplicedRows::SplicedRows(const SplicedLevel& level, const SplicedLevel* above, const BaseLevel& base, bool has_coverage,
                         int threads)
    : level_(level),
      base_(base),
      differences_(level.bricks, above != nullptr ? &above->bricks : nullptr, level.parents, has_coverage,
                   callers_thread()),
      rows_{rows_of(0), rows_of(1), rows_of(2)},
      starts_(starts()) {
  for (std::size_t c = 0; c < recent_.size(); ++c)
    if (base.columns[c] != nullptr) recent_[c] = std::make_unique<RecentChunks>(*base.columns[c], threads);
}

std::vector<SplicedRows::Rows> SplicedRows::rows_of(std::size_t counted) const {
  std::vector<Rows> out;
  std::uint64_t begin = 0;
  for (const SplicedBricks& run : level_.runs) {
    const auto before = [&](std::uint64_t brick) {
      return run.is_new ? differences_.rows_before(brick)[counted] : base_.before[brick][counted];
    };
    const std::uint64_t first = before(run.first), count = before(run.first + run.count) - first;
    out.push_back({run.is_new, first, begin, begin + count});
    begin += count;
  }
  return out;
}

/// Returns the column `first`: the rows before every bricks_per_start-th brick, and the numbers of rows.
std::vector<std::uint64_t> SplicedRows::starts() const {
  std::vector<std::uint64_t> out;
  BrickRows all{};
  std::uint64_t brick = 0;
  for (const SplicedBricks& run : level_.runs)
    for (std::uint64_t b = run.first; b < run.first + run.count; ++b, ++brick) {
      if (brick % bricks_per_start == 0) out.insert(out.end(), all.begin(), all.end());
      const BrickRows begin = run.is_new ? differences_.rows_before(b) : base_.before[b];
      const BrickRows end = run.is_new ? differences_.rows_before(b + 1) : base_.before[b + 1];
      for (std::size_t c = 0; c < all.size(); ++c) all[c] += end[c] - begin[c];
    }
  out.insert(out.end(), all.begin(), all.end());
  return out;
}

std::uint64_t SplicedRows::rows(LevelColumn column) const {
  if (column == LevelColumn::first) return starts_.size() / BrickRows{}.size();
  const std::vector<Rows>& rows = rows_[counted_by(column)];
  return rows.empty() ? 0 : rows.back().end;
}

void SplicedRows::collect(LevelColumn column, std::uint64_t first, std::uint64_t count,
                          std::vector<std::uint8_t>& scratch) const {
  const std::size_t width = row_of(column).bytes;
  scratch.resize(count * width);
  if (column == LevelColumn::first) {
    std::memcpy(scratch.data(), starts_.data() + first * BrickRows{}.size(), scratch.size());
    return;
  }
  const std::vector<Rows>& rows = rows_[counted_by(column)];
  auto at = std::ranges::upper_bound(rows, first, {}, &Rows::end);
  for (std::uint64_t row = first; row < first + count; ++at) {
    const std::uint64_t end = std::min(at->end, first + count), from = at->first + (row - at->begin);
    const std::span<std::uint8_t> to(scratch.data() + (row - first) * width, (end - row) * width);
    if (at->is_new)
      differences_.collect(column, from, to);
    else
      recent_[std::size_t(column)]->read(from, width, to);
    row = end;
  }
}

/// Reads the chunks of the new column that have the same rows as a chunk of the stored column.
void SplicedRows::read_chunks(const Rows& run, std::uint64_t all, const Hdf5Rows& stored,
                              std::vector<std::vector<std::uint8_t>>& chunks) {
  const std::uint64_t per_chunk = stored.chunk_rows();
  const auto distance = std::int64_t(run.first - run.begin);  // from a row of the new column to its stored row
  if (run.is_new || run.begin == run.end || distance % std::int64_t(per_chunk) != 0) return;
  const std::int64_t moved = distance / std::int64_t(per_chunk);
  for (std::uint64_t chunk = (run.begin + per_chunk - 1) / per_chunk; chunk < chunks.size(); ++chunk) {
    const std::uint64_t first = chunk * per_chunk, rows = std::min(per_chunk, run.end - std::min(first, run.end));
    const std::uint64_t index = chunk + std::uint64_t(moved), of_stored = stored.rows() - index * per_chunk;
    if (rows < per_chunk && (chunk + 1 < chunks.size() || run.end != all)) return;
    if (rows == std::min(per_chunk, of_stored)) chunks[chunk] = stored.stored_chunk(index);
  }
}

void SplicedRows::read_chunks(LevelColumn column) {
  const std::uint64_t all = rows(column);
  const Hdf5Rows& stored = *base_.columns[std::size_t(column)];
  if (column == LevelColumn::first || all == 0 || stored.rows() == 0) return;
  const std::uint64_t per_chunk = rows_per_chunk(all, row_of(column).bytes);
  if (per_chunk != stored.chunk_rows()) return;
  std::vector<std::vector<std::uint8_t>>& chunks = chunks_[std::size_t(column)];
  chunks.resize(chunk_count(all, row_of(column).bytes));
  for (const Rows& run : rows_[counted_by(column)]) read_chunks(run, all, stored, chunks);
  spans_[std::size_t(column)].assign(chunks.begin(), chunks.end());
}

std::uint64_t SplicedRows::copied_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& column : chunks_)
    for (const std::vector<std::uint8_t>& chunk : column) bytes += chunk.size();
  return bytes;
}

}  // namespace gigabake
