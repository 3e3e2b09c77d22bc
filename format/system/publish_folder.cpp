#include "format/system/publish_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "format/system/descriptor.h"
#include "format/system/publish_place.h"
#include "lattice/error.h"

namespace gigabake {

FolderPublication::FolderPublication(std::filesystem::path target)
    : target_(target.has_filename() ? std::move(target) : target.parent_path()) {
  std::error_code ignored;
  if (std::filesystem::exists(target_, ignored) &&
      !(std::filesystem::is_directory(target_, ignored) && std::filesystem::is_empty(target_, ignored)))
    throw InputError(target_, "", "is there already; expected the name of a new folder: remove it or name another");
  aside_ = make_beside(target_, [](const std::filesystem::path& aside) { return ::mkdir(aside.c_str(), 0777) == 0; });
}

FolderPublication::~FolderPublication() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove_all(aside_, ignored);
}

void FolderPublication::publish() {
  const Descriptor folder(aside_, O_RDONLY | O_DIRECTORY);
  if (!folder.is_open() || ::syncfs(folder.get()) != 0) fail_to(target_, "flush to disk");
  rename_into_place(aside_, target_);
  published_ = true;
  flush_folder_of(target_);
}

}  // namespace gigabake
