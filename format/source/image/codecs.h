/// Decoders of what glTF files pack, each with a library that gigabake may have been built without.
///
/// Exact   What a decoder gives depends on the packed bytes alone.
/// Errors  InputError(file, where): bytes that are not as the codec has them, or more than they can unpack to; built
///         without the library, naming its package. Sizes are checked before memory is taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "format/source/image/image_size.h"
#include "format/source/mesh.h"
#include "lattice/rules.h"

namespace gigabake {

/// Why content that requires a glTF extension is refused, where that is for want of a library; nothing where the
/// extension is none of a codec's, or is read.
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
/// Range  Strides and counts as the extension allows them: the caller checks. Returns count · stride bytes.
std::vector<std::uint8_t> decode_meshopt(const std::filesystem::path& file, const std::string& where,
                                         const MeshoptStream& stream, std::span<const std::uint8_t> packed);

// KHR_draco_mesh_compression

struct DracoAttribute {
  std::uint32_t unique_id = 0;
  std::uint32_t components = 0;
  float integers_to_one = 0;  ///< an accessor's integers are shares of this, where not 0
};

struct DracoMesh {
  std::uint64_t points = 0;
  std::vector<std::uint32_t> index;            ///< 3 a triangle
  std::vector<std::vector<float>> attributes;  ///< components · points each, as they were asked for
};

bool has_draco();
/// most_triangles: what the document says; a stream that says more is refused before it is unpacked.
DracoMesh decode_draco(const std::filesystem::path& file, const std::string& where,
                       std::span<const std::uint8_t> packed, std::span<const DracoAttribute> attributes,
                       std::uint64_t most_triangles);

// EXT_texture_webp

bool has_webp();
/// As the header says.
ImageSize webp_size(const EncodedImage& image);
Image decode_webp(const EncodedImage& image);

}  // namespace gigabake
