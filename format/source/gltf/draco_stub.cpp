#include "core/base/error.h"
#include "format/source/image/codecs.h"

namespace gigabake {

bool has_draco() { return false; }

DracoMesh decode_draco(const std::filesystem::path& file, const std::string& where, std::span<const std::uint8_t>,
                       std::span<const DracoAttribute>, std::uint64_t) {
  throw InputError(file, where, *missing_codec("KHR_draco_mesh_compression"));
}

}  // namespace gigabake
