#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {

bool has_meshopt() { return false; }

std::vector<std::uint8_t> decode_meshopt(const std::filesystem::path& file, const std::string& where,
                                         const MeshoptStream&, std::span<const std::uint8_t>) {
  throw InputError(file, where, *missing_codec("EXT_meshopt_compression"));
}

}  // namespace gigabake
