#include "format/source/content/source_bytes.h"

#include <algorithm>
#include <stdexcept>

namespace gigabake {

SourceBytes::SourceBytes(std::vector<std::uint8_t> bytes) : SourceBytes(std::move(bytes), 0) {}

SourceBytes::SourceBytes(std::vector<std::uint8_t> bytes, std::uint64_t begin)
    : memory_(std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes))),
      begin_(begin),
      size_(memory_->size()),
      memory_begin_(begin) {}

SourceBytes::SourceBytes(std::shared_ptr<const ReadableFile> file) : file_(std::move(file)), size_(file_->bytes()) {}

SourceBytes SourceBytes::part(std::uint64_t offset, std::uint64_t bytes) const {
  if (offset > size_ || bytes > size_ - offset) throw std::out_of_range("a part exceeds its bytes");
  SourceBytes out = *this;
  out.begin_ += offset;
  out.size_ = bytes;
  return out;
}

std::span<const std::uint8_t> SourceBytes::look(std::uint64_t offset, std::uint64_t bytes,
                                                std::vector<std::uint8_t>& buffer) const {
  if (!file_) return part(offset, bytes).span();
  if (offset > size_ || bytes > size_ - offset) throw std::out_of_range("a view exceeds its bytes");
  if (buffer.size() < bytes) buffer.resize(bytes);
  const std::span<std::uint8_t> out = std::span(buffer).first(bytes);
  file_->read(begin_ + offset, out);
  return out;
}

std::vector<std::uint8_t> SourceBytes::copy() const {
  std::vector<std::uint8_t> buffer;
  const std::span<const std::uint8_t> bytes = look(0, size_, buffer);
  if (!file_) buffer.assign(bytes.begin(), bytes.end());
  return buffer;
}

std::span<const std::uint8_t> SourceBytes::span() const {
  if (file_) throw std::out_of_range("these bytes are in a file");
  if (!memory_) return {};
  return std::span(*memory_).subspan(begin_ - memory_begin_, size_);
}

void SourceBytes::for_each_block(std::size_t block_bytes,
                                 const std::function<void(std::span<const std::uint8_t>)>& visit) const {
  std::vector<std::uint8_t> buffer;
  for (std::uint64_t at = 0; at < size_; at += block_bytes)
    visit(look(at, std::min<std::uint64_t>(block_bytes, size_ - at), buffer));
}

}  // namespace gigabake
