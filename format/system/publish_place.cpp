#include "format/system/publish_place.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>

#include "core/base/error.h"
#include "format/system/descriptor.h"

namespace gigabake {
namespace {

constexpr int max_attempts = 1000;

void flush(const std::filesystem::path& path, int flags) {
  const Descriptor file(path, flags);
  // Some network file systems cannot sync a folder and return EINVAL. The rename is then as durable as they support.
  if (!file.is_open() || (::fsync(file.get()) != 0 && errno != EINVAL)) fail_to(path, "flush to disk");
}

}  // namespace

void fail_to(const std::filesystem::path& path, const char* what) {
  throw InputError(path, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::filesystem::path create_temporary(const std::filesystem::path& target,
                                       const std::function<bool(const std::filesystem::path&)>& make) {
  // A killed process may have left a file of this name; then the next number is tried.
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    static std::atomic<unsigned> count{0};
    const std::filesystem::path temporary =
        folder_of(target) /
        ("." + target.filename().string() + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".part");
    if (make(temporary)) return temporary;
    if (errno != EEXIST) break;
  }
  fail_to(target, "write");
}

void rename_into_place(const std::filesystem::path& temporary, const std::filesystem::path& target) {
  if (::rename(temporary.c_str(), target.c_str()) != 0) fail_to(target, "rename into place");
}

void flush_folder_of(const std::filesystem::path& target) { flush(folder_of(target), O_RDONLY | O_DIRECTORY); }

void flush_file(const std::filesystem::path& file) { flush(file, O_RDONLY); }

}  // namespace gigabake
