#include "format/system/read_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <sys/stat.h>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/work_counts.h"
#include "format/system/descriptor.h"

namespace gigabake {
namespace {

[[noreturn]] void cannot_read(const std::filesystem::path& path) {
  throw IoError(path, "", std::string("cannot be read: ") + std::strerror(errno));
}

}  // namespace

std::vector<std::uint8_t> read_whole_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw IoError(path, "", "no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw InputError(path, "", "expected a regular file");
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) throw IoError(path, "", "cannot be read: " + error.message());
  if (bytes > max_bytes)
    throw InputError(path, "", "larger than " + std::to_string(max_bytes) + " bytes; split it into tiles");
  MemoryClaim(path).add_items(bytes, 1, "", "bytes of the file");
  std::vector<std::uint8_t> content(bytes);
  count_work(WorkCounter::files_opened);
  count_work(WorkCounter::file_bytes_read, bytes);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(content.data()), std::streamsize(bytes)))
    throw IoError(path, "", "cannot be read to its end");
  return content;
}

FileTail read_tail(const std::filesystem::path& path, std::uint64_t from) {
  FileTail tail;
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open() && errno == ENOENT) return tail;
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0) cannot_read(path);
  if (!S_ISREG(status.st_mode)) throw InputError(path, "", "expected a regular file");
  tail.inode = std::uint64_t(status.st_ino);
  tail.size = std::uint64_t(status.st_size);
  if (tail.size <= from) return tail;
  tail.bytes.resize(tail.size - from);
  std::size_t done = 0;
  while (done < tail.bytes.size()) {
    const ssize_t got = ::pread(file.get(), tail.bytes.data() + done, tail.bytes.size() - done, off_t(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) cannot_read(path);
    if (got == 0) break;  // the file was truncated
    done += std::size_t(got);
  }
  tail.bytes.resize(done);
  return tail;
}

}  // namespace gigabake
