#include "cluster/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "lattice/error.h"

namespace gigabake {
namespace {

/// Where the system keeps temporary files. A TMPDIR that names no folder is left to fail with its name in the message.
std::filesystem::path system_folder() {
  const char* const variable = std::getenv("TMPDIR");
  return variable == nullptr || *variable == '\0' ? "/tmp" : variable;
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::filesystem::path& in) {
  std::error_code ignored;
  if (!in.empty()) std::filesystem::create_directories(in, ignored);
  const std::filesystem::path parent = in.empty() ? system_folder() : in;
  std::string made = (parent / "gigabake-plan-XXXXXX").string();
  if (::mkdtemp(made.data()) == nullptr)
    throw InputError(
        made, "",
        std::string("cannot make the folder: ") + std::strerror(errno) +
            (in.empty() ? "; set the variable TMPDIR to a folder that can be written, or use " : "; use another ") +
            "`scratch` or `no_measure`, which needs none");
  path_ = made;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace gigabake
