#include "cluster/temporary_folder.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "lattice/error.h"

namespace gigabake {

TemporaryFolder::TemporaryFolder(const std::filesystem::path& in) {
  std::error_code ignored;
  if (!in.empty()) std::filesystem::create_directories(in, ignored);
  const std::filesystem::path parent = in.empty() ? std::filesystem::temp_directory_path() : in;
  std::string made = (parent / "gigabake-plan-XXXXXX").string();
  if (::mkdtemp(made.data()) == nullptr)
    throw InputError(made, "",
                     "cannot make the folder; `no_measure` needs none, and TMPDIR or `scratch` names another place");
  path_ = made;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace gigabake
