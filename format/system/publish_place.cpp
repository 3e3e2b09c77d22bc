#include "format/system/publish_place.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>
#include <vector>

#include "core/base/error.h"
namespace gigabake {
namespace {

constexpr int max_attempts = 1000;

void flush(const std::filesystem::path& path, int flags) {
  const Descriptor file(path, flags);
  // Some network file systems cannot sync a folder and return EINVAL. The rename is then as durable as they support.
  if (!file.is_open() || (::fsync(file.get()) != 0 && errno != EINVAL)) fail_to(path, "flush to disk");
}

constexpr std::string_view suffix = ".part";

bool lock(const Descriptor& file) { return ::flock(file.get(), LOCK_EX | LOCK_NB) == 0; }

/// Returns true if the open file or folder was removed.
bool is_removed(const Descriptor& file) {
  struct stat found {};
  return ::fstat(file.get(), &found) == 0 && found.st_nlink == 0;
}

}  // namespace

void fail_to(const std::filesystem::path& path, const char* what) {
  throw InputError(path, "", std::string("cannot ") + what + ": " + std::strerror(errno));
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
  return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

std::optional<std::string> target_of_temporary(const std::string& name) {
  if (!name.starts_with('.') || !name.ends_with(suffix)) return std::nullopt;
  const std::string named = name.substr(1, name.size() - 1 - suffix.size());
  const std::size_t dot = named.rfind('.');
  if (dot == std::string::npos || dot == 0) return std::nullopt;
  const std::string_view owner = std::string_view(named).substr(dot + 1);
  const bool is_owner = std::ranges::count(owner, '-') == 1 && owner.front() != '-' && owner.back() != '-' &&
                        std::ranges::all_of(owner, [](unsigned char c) { return std::isdigit(c) != 0 || c == '-'; });
  return is_owner ? std::optional(named.substr(0, dot)) : std::nullopt;
}

std::filesystem::path create_temporary(const std::filesystem::path& target,
                                       const std::function<bool(const std::filesystem::path&)>& make) {
  // A killed process may have left a file of this name; then the next number is tried.
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    static std::atomic<unsigned> count{0};
    const std::filesystem::path temporary =
        folder_of(target) / ("." + target.filename().string() + "." + std::to_string(::getpid()) + "-" +
                             std::to_string(count++) + std::string(suffix));
    if (make(temporary)) return temporary;
    if (errno != EEXIST) break;
  }
  fail_to(target, "write");
}

LockedTemporary create_locked_temporary(const std::filesystem::path& target,
                                        const std::function<Descriptor(const std::filesystem::path&)>& make) {
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    LockedTemporary out;
    out.path = create_temporary(target, [&](const std::filesystem::path& name) {
      out.lock = make(name);
      return out.lock.is_open();
    });
    lock(out.lock);
    if (!is_removed(out.lock)) return out;  // another process may have removed it before it was locked
  }
  fail_to(target, "write");
}

void remove_abandoned_temporaries(const std::filesystem::path& target) {
  const std::string of = target.filename().string();
  std::error_code error;
  std::vector<std::filesystem::path> found;
  for (std::filesystem::directory_iterator entry(folder_of(target), error), end; !error && entry != end;
       entry.increment(error))
    if (target_of_temporary(entry->path().filename().string()) == of) found.push_back(entry->path());
  for (const std::filesystem::path& path : found) {
    const bool is_folder = std::filesystem::is_directory(std::filesystem::symlink_status(path, error));
    const Descriptor opened(path, O_NOFOLLOW | (is_folder ? O_RDONLY | O_DIRECTORY : O_RDWR));
    if (opened.is_open() && lock(opened)) std::filesystem::remove_all(path, error);
  }
}

void rename_into_place(const std::filesystem::path& temporary, const std::filesystem::path& target) {
  if (::rename(temporary.c_str(), target.c_str()) != 0) fail_to(target, "rename into place");
}

void flush_folder_of(const std::filesystem::path& target) { flush(folder_of(target), O_RDONLY | O_DIRECTORY); }

void flush_file(const std::filesystem::path& file) { flush(file, O_RDONLY); }

}  // namespace gigabake
