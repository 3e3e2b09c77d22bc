#include "format/system/publish_folder.h"

#include <cerrno>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "format/system/descriptor.h"
#include "format/system/publish_place.h"

namespace gigabake {
FolderPublication::FolderPublication(std::filesystem::path target)
    : target_(target.has_filename() ? std::move(target) : target.parent_path()) {
  std::error_code ignored;
  if (std::filesystem::exists(target_, ignored) &&
      !(std::filesystem::is_directory(target_, ignored) && std::filesystem::is_empty(target_, ignored)))
    throw InputError(target_, "", "is there already; expected the name of a new folder: remove it or name another");
  const std::string prefix = "." + target_.filename().string() + "." + std::to_string(::getpid()) + "-";
  constexpr int most_attempts = 1000;  // a killed process may have left some
  for (int attempt = 0; attempt < most_attempts; ++attempt) {
    aside_ = folder_of(target_) / (prefix + std::to_string(attempt) + ".part");
    if (::mkdir(aside_.c_str(), 0777) == 0) return;
    if (errno != EEXIST) break;
  }
  fail_to(target_, "write");
}

FolderPublication::~FolderPublication() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove_all(aside_, ignored);
}

void FolderPublication::publish() {
  const Descriptor folder(aside_, O_RDONLY | O_DIRECTORY);
  if (!folder.is_open() || ::syncfs(folder.get()) != 0) fail_to(target_, "flush to disk");
  if (::rename(aside_.c_str(), target_.c_str()) != 0) fail_to(target_, "rename into place");
  published_ = true;
  const Descriptor parent(folder_of(target_), O_RDONLY | O_DIRECTORY);
  if (!parent.is_open() || (::fsync(parent.get()) != 0 && errno != EINVAL)) fail_to(target_, "flush to disk");
}

}  // namespace gigabake
