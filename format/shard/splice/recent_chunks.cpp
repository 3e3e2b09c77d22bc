#include "format/shard/splice/recent_chunks.h"

#include <algorithm>
#include <cstring>

namespace gigabake {

std::shared_ptr<RecentChunks::Chunk> RecentChunks::chunk(std::uint64_t index, std::size_t row_bytes) {
  std::shared_ptr<Chunk> chunk;
  {
    const std::scoped_lock lock(mutex_);
    chunks_.erase(chunks_.begin(), chunks_.lower_bound(index - std::min(index, kept_)));
    std::shared_ptr<Chunk>& found = chunks_[index];
    if (found == nullptr) found = std::make_shared<Chunk>();
    chunk = found;
  }
  std::call_once(chunk->unpacked, [&] {
    const std::uint64_t first = index * rows_.chunk_rows(), count = std::min(rows_.chunk_rows(), rows_.rows() - first);
    chunk->bytes.resize(count * row_bytes);
    rows_.read(first, count, chunk->bytes.data());
  });
  return chunk;
}

void RecentChunks::read(std::uint64_t first, std::size_t row_bytes, std::span<std::uint8_t> to) {
  const std::uint64_t per_chunk = rows_.chunk_rows();
  while (!to.empty()) {
    const std::uint64_t skipped = first % per_chunk;
    const std::shared_ptr<const Chunk> from = chunk(first / per_chunk, row_bytes);
    const std::uint64_t count = std::min<std::uint64_t>(per_chunk - skipped, to.size() / row_bytes);
    std::memcpy(to.data(), from->bytes.data() + skipped * row_bytes, count * row_bytes);
    first += count;
    to = to.subspan(count * row_bytes);
  }
}

}  // namespace gigabake
