#include "format/system/readable_file.h"

#include <cerrno>
#include <cstring>
#include <sys/stat.h>

#include "core/base/error.h"
#include "core/base/work_counts.h"

namespace gigabake {

ReadableFile::ReadableFile(std::filesystem::path path)
    : path_(std::move(path)), file_(path_, O_RDONLY | O_NONBLOCK) {  // opening a pipe must not wait for its writer
  struct stat info {};
  if (!file_.is_open() && (errno == ENOENT || errno == ENOTDIR)) throw IoError(path_, "", "no such file");
  if (!file_.is_open() || ::fstat(file_.get(), &info) != 0)
    throw IoError(path_, "", std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(info.st_mode)) throw InputError(path_, "", "expected a regular file");
  bytes_ = std::uint64_t(info.st_size);
}

void ReadableFile::read(std::uint64_t offset, std::span<std::uint8_t> out) const {
  count_work(WorkCounter::file_bytes_read, out.size());
  while (!out.empty()) {
    const ssize_t got = ::pread(file_.get(), out.data(), out.size(), off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw IoError(path_, "", std::string("cannot be read: ") + std::strerror(errno), offset);
    if (got == 0) throw IoError(path_, "", "became shorter while it was read", offset);
    out = out.subspan(std::size_t(got));
    offset += std::uint64_t(got);
  }
}

}  // namespace gigabake
