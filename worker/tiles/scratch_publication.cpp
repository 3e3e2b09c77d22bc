#include "worker/tiles/scratch_publication.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"

namespace gigabake {
namespace {

[[noreturn]] void fail_to_write(const std::filesystem::path& path) {
  throw IoError(path, "", std::string("cannot write: ") + std::strerror(errno));
}

/// Creates the temporary file; reports a full disk as IoError because it is not a fault of the input.
Publication publication_of(const std::filesystem::path& target) {
  make_scratch_folder(target.parent_path());
  try {
    return Publication(target);
  } catch (const InputError&) {
    fail_to_write(target);
  }
}

}  // namespace

ScratchPublication::ScratchPublication(std::filesystem::path target)
    : target_(std::move(target)), publication_(publication_of(target_)), file_(publication_.temporary(), O_WRONLY) {
  if (!file_.is_open()) fail_to_write(target_);
}

void ScratchPublication::expect_room(std::uint64_t bytes) const {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(target_.parent_path(), unknown);
  if (!unknown && space.available < bytes)
    throw IoError(target_, "",
                  "needs " + readable_size(bytes) + " on a disk that has " + readable_size(space.available) +
                      " left; name another folder with `scratch` or raise `memory_bytes`");
}

std::uint64_t ScratchPublication::append(std::span<const std::uint8_t> bytes) {
  if (!file_.write_all(bytes)) fail_to_write(target_);
  return std::exchange(bytes_, bytes_ + bytes.size());
}

void ScratchPublication::put(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::pwrite(file_.get(), bytes.data(), bytes.size(), off_t(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) fail_to_write(target_);
    bytes = bytes.subspan(std::size_t(put));
    offset += std::uint64_t(put);
  }
}

void ScratchPublication::publish() {
  file_ = Descriptor();
  try {
    publication_.publish(Durability::while_up);
  } catch (const InputError&) {
    fail_to_write(target_);
  }
}

void make_scratch_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(folder, "", "cannot make the scratch folder: " + error.message());
}

ScratchLock::ScratchLock(std::filesystem::path file) : lock_(file += ".lock", O_RDWR | O_CREAT | O_NOFOLLOW) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  while (lock_.is_open() && ::fcntl(lock_.get(), F_OFD_SETLKW, &whole) != 0 && errno == EINTR) {
  }
  // If locking fails, two ranks may do the same work; each then publishes a complete file.
}

}  // namespace gigabake
