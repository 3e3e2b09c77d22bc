#include "format/system/random_access_file.h"

#include <cerrno>
#include <cstring>
#include <unistd.h>
#include <utility>

#include "core/base/error.h"
#include "core/base/work_counts.h"

namespace gigabake {

RandomAccessFile::RandomAccessFile(std::filesystem::path target, const std::filesystem::path& temporary,
                                   std::uint64_t bytes)
    : target_(std::move(target)), file_(temporary, O_RDWR) {
  if (!file_.is_open() || ::ftruncate(file_.get(), off_t(bytes)) != 0) fail("write");
}

void RandomAccessFile::write(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_.get(), bytes.data(), bytes.size(), off_t(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("write");
    bytes = bytes.subspan(std::size_t(written));
    offset += std::uint64_t(written);
  }
}

void RandomAccessFile::read(std::uint64_t offset, std::span<std::uint8_t> bytes) const {
  count_work(WorkCounter::file_bytes_read, bytes.size());
  while (!bytes.empty()) {
    const ssize_t got = ::pread(file_.get(), bytes.data(), bytes.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail("read back");
    bytes = bytes.subspan(std::size_t(got));
    offset += std::uint64_t(got);
  }
}

void RandomAccessFile::fail(const char* what) const {
  throw InputError(target_, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

}  // namespace gigabake
