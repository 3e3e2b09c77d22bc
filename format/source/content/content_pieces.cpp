#include "format/source/content/content_pieces.h"

#include <algorithm>

#include "format/source/content/gzip.h"

namespace gigabake {

ContentPieces::ContentPieces(const TileRef& tile, const SourceFiles& files)
    : begin_(tile.range.begin), end_(tile.range.end) {
  std::uint64_t size = files.size_of(tile.path);
  std::vector<std::uint8_t> head(3);  // is_gzip() needs 3 bytes
  if (!tile.archive) {
    file_.open(tile.path, std::ios::binary);
    file_.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  }
  if (tile.archive || is_gzip(head)) {
    whole_ = files.read_content(tile.path);
    size = whole_.size();
  }
  end_ = end_ == 0 ? size : std::min(end_, size);
  begin_ = std::min(begin_, end_);
}

std::vector<std::uint8_t> ContentPieces::read(std::uint64_t offset, std::uint64_t bytes) {
  offset = std::min(offset, end_ - begin_);
  bytes = std::min(bytes, end_ - begin_ - offset);
  const std::uint64_t at = begin_ + offset;
  if (!whole_.empty()) return {whole_.begin() + std::ptrdiff_t(at), whole_.begin() + std::ptrdiff_t(at + bytes)};
  std::vector<std::uint8_t> out(bytes);
  file_.clear();
  file_.seekg(std::streamoff(at));
  file_.read(reinterpret_cast<char*>(out.data()), std::streamsize(bytes));
  out.resize(std::size_t(std::max(file_.gcount(), std::streamsize(0))));
  return out;
}

}  // namespace gigabake
