#include "format/system/publish_folder.h"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "core/base/error.h"
#include "format/system/descriptor.h"
#include "format/system/publish_place.h"

namespace gigabake {

FolderPublication::FolderPublication(std::filesystem::path target, Replaces replaces)
    : target_(target.has_filename() ? std::move(target) : target.parent_path()), replaces_(replaces) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(target_, ignored);
  if (std::filesystem::exists(target_, ignored) &&
      !(is_folder && (replaces_ == Replaces::a_folder || std::filesystem::is_empty(target_, ignored))))
    throw InputError(target_, "", "exists already; expected the name of a new folder: remove it or name another");
  remove_abandoned_temporaries(target_);
  LockedTemporary made = create_locked_temporary(target_, [](const std::filesystem::path& temporary) {
    return ::mkdir(temporary.c_str(), 0777) == 0 ? Descriptor(temporary, O_RDONLY | O_DIRECTORY) : Descriptor();
  });
  temporary_ = std::move(made.path);
  lock_ = std::move(made.lock);
}

FolderPublication::~FolderPublication() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove_all(temporary_, ignored);
}

bool FolderPublication::swap_in() const {
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) return true;
  if (errno == ENOENT) return false;  // the target does not exist
  const std::filesystem::path before =
      create_temporary(target_, [](const std::filesystem::path& name) { return ::mkdir(name.c_str(), 0777) == 0; });
  rename_into_place(target_, before);
  rename_into_place(temporary_, target_);
  rename_into_place(before, temporary_);
  return true;
}

void FolderPublication::publish() {
  const Descriptor folder(temporary_, O_RDONLY | O_DIRECTORY);
  if (!folder.is_open() || ::syncfs(folder.get()) != 0) fail_to(target_, "flush to disk");
  if (replaces_ == Replaces::a_folder && swap_in()) {
    flush_folder_of(target_);
    return;  // the replaced folder is at temporary(), which the destructor removes
  }
  rename_into_place(temporary_, target_);
  published_ = true;
  flush_folder_of(target_);
}

}  // namespace gigabake
