#include "core/base/error.h"
#include "format/source/tiles/archive.h"

namespace gigabake {

struct Archive::State {};

Archive::Archive(const std::filesystem::path& file) : file_(file) {
  throw InputError(file, "",
                   "is an archive, and this gigabake was built without libzip; install libzip-dev and build again, or "
                   "unpack it");
}

Archive::~Archive() = default;

// No archive can be created, so none of these functions is called.
std::optional<std::uint64_t> Archive::size_of(const std::string&) const { return {}; }
std::vector<std::uint8_t> Archive::read(const std::string&, std::uint64_t) const { return {}; }

}  // namespace gigabake
