/// The header of a PLY (Stanford polygon file), which declares the elements and the types of their values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gigabake {

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_count(PlyType type);
bool is_integer(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;  ///< type of the value, or of the items of a list
  std::optional<PlyType> count;     ///< integer type of the length of a list; nullopt if the property is no list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Returns the index of the first property that has one of the names.
  std::optional<std::size_t> find(std::initializer_list<const char*> names) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures;  ///< "comment TextureFile NAME", as MeshLab writes it
  std::size_t bytes = 0;              ///< size of the header: the offset of the elements
  std::size_t lines = 0;              ///< number of lines of the header
};

/// Reads the header. `bytes` is the file or its beginning.
/// Errors  InputError with the line: the header is not a PLY 1.0 header, has an unknown type or keyword, an invalid
///         count, or no end. Also if an element has more than 1024 properties.
PlyHeader read_ply_header(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace gigabake
