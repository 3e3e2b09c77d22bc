#include "format/shard/hdf5/file_image.h"

#include <algorithm>
#include <climits>
#include <sys/uio.h>

namespace gigabake {

void FileImage::begin_file() noexcept {
  pieces_.clear();
  copied_.clear();
  length_ = 0;
  chunks_ = ChunkMemory::copied;
}

void FileImage::write(std::uint64_t at, const std::uint8_t* bytes, std::size_t count, bool is_chunk) {
  length_ = std::max(length_, at + count);
  if (is_chunk) last_chunk_ = at;
  if (is_chunk && chunks_ == ChunkMemory::referred) {
    pieces_.push_back({at, count, bytes, 0});
    return;
  }
  pieces_.push_back({at, count, nullptr, copied_.size()});
  copied_.insert(copied_.end(), bytes, bytes + count);
}

void FileImage::read(std::uint64_t at, std::uint8_t* bytes, std::size_t count) const {
  std::fill_n(bytes, count, std::uint8_t(0));
  for (const Piece& piece : pieces_) {
    const std::uint64_t begin = std::max(at, piece.at), end = std::min(at + count, piece.end());
    if (begin < end) std::copy_n(bytes_of(piece) + (begin - piece.at), end - begin, bytes + (begin - at));
  }
}

/// Writes pieces that follow each other without a gap.
bool FileImage::write_run(const Descriptor& file, const Piece* pieces, std::size_t count) const {
  std::vector<iovec> parts(count);
  for (std::size_t i = 0; i < count; ++i) parts[i] = {const_cast<std::uint8_t*>(bytes_of(pieces[i])), pieces[i].count};
  return file.write_all_at(parts, pieces[0].at);
}

bool FileImage::write_to(const Descriptor& file) const {
  // In the order of the writes, so that the last write to an address remains.
  for (std::size_t first = 0, end = 0; first < pieces_.size(); first = end) {
    for (end = first + 1; end < pieces_.size() && end - first < IOV_MAX && pieces_[end].at == pieces_[end - 1].end();)
      ++end;
    if (!write_run(file, pieces_.data() + first, end - first)) return false;
  }
  return file.set_length(length_);
}

}  // namespace gigabake
