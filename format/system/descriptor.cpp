#include "format/system/descriptor.h"

#include <cerrno>

namespace gigabake {

bool Descriptor::write_all(std::span<const std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    bytes = bytes.subspan(std::size_t(written));
  }
  return true;
}

bool Descriptor::write_all_at(std::span<iovec> parts, std::uint64_t at) const {
  while (!parts.empty()) {
    const ssize_t written = ::pwritev(fd_, parts.data(), int(parts.size()), off_t(at));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return false;
    at += std::uint64_t(written);
    std::size_t rest = std::size_t(written);
    for (; !parts.empty() && rest >= parts.front().iov_len; parts = parts.subspan(1)) rest -= parts.front().iov_len;
    if (parts.empty()) break;
    parts.front().iov_base = static_cast<std::uint8_t*>(parts.front().iov_base) + rest;
    parts.front().iov_len -= rest;
  }
  return true;
}

bool Descriptor::set_length(std::uint64_t bytes) const { return ::ftruncate(fd_, off_t(bytes)) == 0; }

}  // namespace gigabake
