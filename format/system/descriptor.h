/// A file descriptor that its owner closes.
#pragma once

#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <span>
#include <sys/uio.h>
#include <unistd.h>
#include <utility>

#include "core/base/work_counts.h"

namespace gigabake {

class Descriptor {
 public:
  Descriptor() = default;
  /// Opens the file with the flags of open(2). If is_open() is false afterwards, errno has the reason.
  Descriptor(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    count_work(WorkCounter::files_opened);
  }
  /// Returns another descriptor of an open file. If is_open() is false, errno has the reason.
  static Descriptor duplicate(int fd) {
    Descriptor copy;
    copy.fd_ = ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
    return copy;
  }
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  bool is_open() const { return fd_ >= 0; }
  int get() const { return fd_; }

  /// Writes all of `bytes` at the file's position. Returns false on failure; errno has the reason, and a part may have
  /// been written.
  bool write_all(std::span<const std::uint8_t> bytes) const;
  /// Writes all of `parts`, one after the other, from byte `at` of the file. Changes `parts`. Returns false on failure,
  /// as write_all() does.
  /// Range   At most IOV_MAX parts.
  bool write_all_at(std::span<iovec> parts, std::uint64_t at) const;
  /// Sets the length of the file. Returns false on failure; errno has the reason.
  bool set_length(std::uint64_t bytes) const;

 private:
  int fd_ = -1;
};

}  // namespace gigabake
