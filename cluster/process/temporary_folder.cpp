#include "cluster/process/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/file.h>
#include <system_error>
#include <vector>

#include "core/base/error.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

constexpr char prefix[] = "gigabake-plan-";
/// The name of a new folder. The folder gets its final name only once it is locked.
constexpr char unlocked_template[] = "gigabake-new-XXXXXX";
constexpr std::size_t random_characters = 6;

/// Removes folders whose process no longer holds its lock. Failures to remove a folder are harmless.
void remove_temporary_files(const fs::path& parent) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator it(parent, error), end; !error && it != end; it.increment(error))
    if (it->path().filename().string().starts_with(prefix)) found.push_back(it->path());
  for (const fs::path& folder : found) {
    const Descriptor lock(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW);
    if (lock.is_open() && ::flock(lock.get(), LOCK_EX | LOCK_NB) == 0) fs::remove_all(folder, error);
  }
}

/// Returns the system's temporary folder. An invalid TMPDIR is kept, so that the later error message names it.
std::filesystem::path system_folder() {
  const char* const variable = std::getenv("TMPDIR");
  return variable == nullptr || *variable == '\0' ? "/tmp" : variable;
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::filesystem::path& in) {
  std::error_code ignored;
  if (!in.empty()) std::filesystem::create_directories(in, ignored);
  const std::filesystem::path parent = in.empty() ? system_folder() : in;
  remove_temporary_files(parent);
  std::string made = (parent / unlocked_template).string();
  if (::mkdtemp(made.data()) == nullptr)
    throw InputError(
        made, "",
        std::string("cannot make the folder: ") + std::strerror(errno) +
            (in.empty() ? "; set the variable TMPDIR to a folder that can be written, or use " : "; use another ") +
            "`scratch` or `no_measure`, which needs none");
  lock_ = Descriptor(made, O_RDONLY | O_DIRECTORY);
  const bool is_locked = lock_.is_open() && ::flock(lock_.get(), LOCK_EX | LOCK_NB) == 0;
  path_ = parent / (prefix + made.substr(made.size() - random_characters));
  fs::rename(made, path_, ignored);
  if (ignored || !is_locked) path_ = made;  // a file system without locks: others must not remove the folder
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace gigabake
