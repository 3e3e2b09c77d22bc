#include <algorithm>
#include <hdf5.h>
#include <mutex>
#include <optional>
#include <utility>

#include "core/codec/chunk_rows.h"
#include "format/shard/hdf5/chunk_codec.h"
#include "format/shard/hdf5/hdf5_file.h"
#include "format/system/meters/stage_clock.h"

namespace gigabake {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A chunk in stored form, either packed by encode() or provided by the caller.
struct Chunk {
  Bytes own;
  std::span<const std::uint8_t> given;
  std::span<const std::uint8_t> bytes() const { return own.empty() ? given : own; }
};

struct ChunkOfColumn {
  std::size_t column, number;
};

std::size_t rows_per_chunk_of(const ColumnRows& c) { return rows_per_chunk(c.rows, c.column.row_bytes()); }

std::vector<ChunkOfColumn> all_chunks(std::span<const ColumnRows> columns) {
  std::vector<ChunkOfColumn> chunks;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t count = chunk_count(columns[c].rows, columns[c].column.row_bytes());
    for (std::size_t i = 0; i < count; ++i) chunks.push_back({c, i});
  }
  return chunks;
}

/// Encodes chunk `number`. Stored chunks are always complete: the last chunk of a column is padded with zeros.
Bytes encode(const ColumnRows& from, std::size_t number, Codec codec, Bytes& scratch) {
  const Hdf5Column& column = from.column;
  const ChunkFilters filters = column.filters(codec);
  const std::size_t per_chunk = rows_per_chunk_of(from), first = number * per_chunk;
  const std::size_t rows = std::min<std::size_t>(per_chunk, from.rows - first);
  const std::span<const std::uint8_t> raw = from.get(first, rows, scratch);
  if (rows == per_chunk) return encode_chunk(raw, filters);
  Bytes padded(raw.begin(), raw.end());
  padded.resize(per_chunk * column.row_bytes(), 0);
  return encode_chunk(padded, filters);
}

bool are_packed(std::span<const ColumnRows> columns) {
  return std::all_of(columns.begin(), columns.end(), [](const ColumnRows& c) {
    const auto is_stored = [](const auto& chunk) { return !chunk.empty(); };
    return c.rows == 0 || (!c.stored.empty() && std::ranges::all_of(c.stored, is_stored));
  });
}

Chunk pack(const ColumnRows& from, std::size_t number, Codec codec, Bytes& scratch) {
  if (!from.stored.empty() && !from.stored[number].empty()) return {{}, from.stored[number]};
  const InStage packing(BakeStage::packing);
  return {encode(from, number, codec, scratch), {}};
}

}  // namespace

/// A writer that stores chunks, columns and groups in a fixed order, although chunks become ready in any order. The
/// file's bytes are therefore independent of the threads.
class ColumnsInOrder {
 public:
  ColumnsInOrder(Hdf5File& file, std::span<const ColumnRows> columns, Codec codec)
      : file_(file),
        columns_(columns),
        codec_(codec),
        is_packed_(are_packed(columns)),
        chunks_(all_chunks(columns)),
        ready_(chunks_.size()) {
    stored_.resize(columns.size());
  }

  std::vector<std::uint64_t> write(const ThreadPool& all_threads) {
    // If all columns are packed already, waking threads would take longer than storing the chunks.
    const ThreadPool& pool = is_packed_ ? callers_thread() : all_threads;
    std::optional<InStage> writing;
    if (is_packed_) writing.emplace(BakeStage::writing);
    std::vector<Bytes> scratch(std::size_t(pool.threads()));
    pool.parallel_for(chunks_.size(), 1, [&](std::size_t i, std::size_t, int thread) {
      give(i, pack(columns_[chunks_[i].column], chunks_[i].number, codec_, scratch[std::size_t(thread)]));
    });
    make_columns_up_to(columns_.size());
    set_.reset();
    return stored_;
  }

 private:
  /// Marks the chunk as ready and stores all chunks that are next in order and ready. If another thread is storing
  /// already, leaves all storing to that thread.
  void give(std::size_t chunk, Chunk packed) {
    std::unique_lock lock(mutex_);
    ready_[chunk] = std::move(packed);
    if (std::exchange(storing_, true)) return;
    std::optional<InStage> writing;
    if (!is_packed_) writing.emplace(BakeStage::writing);
    for (; next_ < ready_.size() && !ready_[next_].bytes().empty(); ++next_) {
      const Chunk taken = std::exchange(ready_[next_], {});
      lock.unlock();
      store(chunks_[next_], taken);
      lock.lock();
    }
    storing_ = false;
  }

  void store(const ChunkOfColumn& at, const Chunk& chunk) {
    const std::span<const std::uint8_t> bytes = chunk.bytes();
    make_columns_up_to(at.column + 1);
    const ColumnRows& column = columns_[at.column];
    configure_hdf5({file_.path(), column.column.name});
    // A chunk that was packed here is freed after this call; the caller of write_columns() keeps the others.
    file_.set_chunk_memory(chunk.own.empty() ? ChunkMemory::referred : ChunkMemory::copied);
    file_.write_chunk(*set_, column.column, at.number * rows_per_chunk_of(column), bytes);
    stored_[at.column] += bytes.size();
  }

  /// Creates the columns before `end`. Columns without rows have no chunks, so store() would never create them.
  void make_columns_up_to(std::size_t end) {
    for (; made_ < end; ++made_) {
      const ColumnRows& c = columns_[made_];
      set_.reset();
      configure_hdf5({file_.path(), c.column.name});
      if (!c.group.empty()) file_.make_group(c.group);
      set_.emplace(file_.make_column(c.column, c.rows, codec_));
    }
  }

  Hdf5File& file_;
  const std::span<const ColumnRows> columns_;
  const Codec codec_;
  const bool is_packed_;
  const std::vector<ChunkOfColumn> chunks_;
  std::mutex mutex_;          ///< guards the next three members
  std::vector<Chunk> ready_;  ///< per chunk; no bytes: not ready, or stored already
  std::size_t next_ = 0;      ///< the next chunk to store; changed only by the storing thread
  bool storing_ = false;
  // Used only by the storing thread:
  std::size_t made_ = 0;       ///< number of columns created
  std::optional<Hdf5Id> set_;  ///< the last column created
  std::vector<std::uint64_t> stored_;
};

std::vector<std::uint64_t> Hdf5File::write_columns(std::span<const ColumnRows> columns, Codec codec,
                                                   const ThreadPool& pool) {
  return ColumnsInOrder(*this, columns, codec).write(pool);
}

}  // namespace gigabake
