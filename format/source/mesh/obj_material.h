/// Wavefront MTL: the materials of an OBJ file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/source_files.h"
#include "format/source/source_warning.h"

namespace gigabake {

/// An image that a material names, and where it is on the surface.
struct ObjMap {
  std::string name;                                 ///< of the file as written; empty: none
  std::array<double, 2> scale{1, 1}, offset{0, 0};  ///< -s and -o: of texture coordinates, offset last
  bool is_clamped = false;                          ///< -clamp on

  /// Returns texture coordinates as Primitive has them, v downwards, with scale and offset.
  std::array<float, 2> uv(const std::array<float, 2>& uv) const;
  bool is_placed_as(const ObjMap& other) const {
    return scale == other.scale && offset == other.offset && is_clamped == other.is_clamped;
  }
};

struct ObjMaterial {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< Kd and d, taken as linear
  ObjMap color_map, alpha_map;                  ///< map_Kd and map_d

  bool has_map() const { return !color_map.name.empty() || !alpha_map.name.empty(); }
  /// Returns the map whose place on the surface holds for both.
  const ObjMap& placed_map() const { return color_map.name.empty() ? alpha_map : color_map; }
};

/// Returns materials by name. Keywords are read in upper and lower case. A single number of Kd is all three colours.
/// `d` has precedence over `Tr`; `Tr 1` alone is opaque, as the programs that write it mean.
/// What is not used is counted in `warnings`, with `file` and line as the example.
std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                                            SourceWarnings& warnings);

/// A name in an OBJ or MTL, and the file that it means, which may be missing; none if no file of the source can have
/// that name.
struct NamedFile {
  std::string name;
  std::optional<std::filesystem::path> file;

  bool is_there(const SourceFiles& files) const { return file && files.has(*file); }
};

/// Returns the file that `base` names. A name that leads out of the source's folder, as the absolute path of another
/// machine does, means the file of that name next to `base`.
NamedFile named_file(const std::filesystem::path& base, std::string_view name, const SourceFiles& files);

/// Returns the files that an OBJ names by `mtllib`: the whole rest of the line is one name if there is such a file,
/// else each word is one.
std::vector<NamedFile> material_files(const std::filesystem::path& file, const ObjLine& line, const SourceFiles& files);

}  // namespace gigabake
