#include "format/system/file_stamp.h"

#include <cerrno>
#include <chrono>
#include <sys/stat.h>

#include "format/system/descriptor.h"

namespace gigabake {
namespace {

constexpr std::int64_t settled_after_ns = 2'000'000'000;

std::int64_t nanoseconds(const timespec& t) { return std::int64_t(t.tv_sec) * 1'000'000'000 + t.tv_nsec; }

}  // namespace

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  const Descriptor file(path, O_RDONLY | O_NONBLOCK);  // opening a pipe must not wait for its writer
  if (!file.is_open()) {
    if (errno == ENOENT || errno == ENOTDIR) return FileStamp{};
    return std::nullopt;
  }
  struct stat info {};
  if (::fstat(file.get(), &info) != 0) return std::nullopt;
  if (!S_ISREG(info.st_mode)) return FileStamp{};
  return FileStamp{std::uint64_t(info.st_size), nanoseconds(info.st_mtim), nanoseconds(info.st_ctim),
                   std::uint64_t(info.st_ino)};
}

bool is_settled(const FileStamp& stamp, std::int64_t taken_ns) {
  return stamp == FileStamp{} || (stamp.mtime_ns <= taken_ns - settled_after_ns &&  //
                                  stamp.ctime_ns <= taken_ns - settled_after_ns);
}

StampedFile stamped(const std::string& name, const std::filesystem::path& path) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::int64_t taken_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  const std::optional<FileStamp> stamp = stamp_of(path);
  if (!stamp) return {name, {}, false};
  return {name, *stamp, is_settled(*stamp, taken_ns)};
}

}  // namespace gigabake
