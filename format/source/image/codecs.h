/// Decoders of packed data in glTF files. Each uses a library that gigabake may be built without.
///
/// Exact   The output of a decoder depends only on the packed bytes.
/// Errors  InputError(file, where): the bytes violate the codec's format, or the declared size is impossible for this
///         number of packed bytes. If gigabake was built without the library, the message names its package. Sizes are
///         checked before memory is allocated.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/rules.h"
#include "format/source/image/image_size.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Returns the reason why a glTF extension that needs a codec is refused: gigabake has no library for it. Returns
/// nullopt if the library exists or the extension needs no codec.
std::optional<std::string> missing_codec(const std::string& extension);

// EXT_meshopt_compression

enum class MeshoptMode : std::uint8_t { attributes, triangles, indices };
template <>
constexpr auto names_of<MeshoptMode>() {
  return std::to_array<std::string_view>({"ATTRIBUTES", "TRIANGLES", "INDICES"});
}
enum class MeshoptFilter : std::uint8_t { none, octahedral, quaternion, exponential };
template <>
constexpr auto names_of<MeshoptFilter>() {
  return std::to_array<std::string_view>({"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"});
}

struct MeshoptStream {
  std::uint64_t count = 0, stride = 0;
  MeshoptMode mode = MeshoptMode::attributes;
  MeshoptFilter filter = MeshoptFilter::none;
};

bool has_meshopt();
/// Returns the unpacked bytes: stream.count · stream.stride.
/// Range   The caller has checked that the extension allows the stride and the count.
std::vector<std::uint8_t> decode_meshopt(const std::filesystem::path& file, const std::string& where,
                                         const MeshoptStream& stream, std::span<const std::uint8_t> packed);

// KHR_draco_mesh_compression

struct DracoAttribute {
  std::uint32_t unique_id = 0;
  std::uint32_t components = 0;
  float integers_to_one = 0;  ///< if not 0, integer components are divided by this
};

struct DracoMesh {
  std::uint64_t points = 0;
  std::vector<std::uint32_t> index;            ///< 3 per triangle
  std::vector<std::vector<float>> attributes;  ///< per requested attribute: components · points values
};

bool has_draco();
/// Decodes a mesh. `max_triangles` is the number that the document declares. A stream that states more triangles is
/// refused before it is unpacked.
DracoMesh decode_draco(const std::filesystem::path& file, const std::string& where,
                       std::span<const std::uint8_t> packed, std::span<const DracoAttribute> attributes,
                       std::uint64_t max_triangles);

// EXT_texture_webp

bool has_webp();
/// Returns the size that the header states.
ImageSize webp_size(const EncodedImage& image);
/// Returns whether the compression changed texels, or may have changed them.
bool is_lossy_webp(const EncodedImage& image);
Image decode_webp(const EncodedImage& image);

}  // namespace gigabake
