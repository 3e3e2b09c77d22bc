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

/// An image that a material names, and its placement on the surface.
struct ObjMap {
  std::string name;                                 ///< name of the image file in the MTL; empty: no image
  std::array<double, 2> scale{1, 1}, offset{0, 0};  ///< -s and -o, applied to texture coordinates, scale first
  bool is_clamped = false;                          ///< -clamp on
  double bump_scale = 1;                            ///< -bm

  /// Returns texture coordinates after scale and offset. Both `uv` and the result have v downwards, as in Primitive.
  std::array<float, 2> uv(const std::array<float, 2>& uv) const;
  bool is_placed_as(const ObjMap& other) const {
    return scale == other.scale && offset == other.offset && is_clamped == other.is_clamped;
  }
};

struct ObjMaterial {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< Kd and d, interpreted as linear
  ObjMap color_map, alpha_map;                  ///< map_Kd and map_d
  ObjMap normal_map;                            ///< `norm`, else `bump`, which may be a height map

  bool has_map() const { return !color_map.name.empty() || !alpha_map.name.empty(); }
  /// Returns the map whose placement applies to both maps.
  const ObjMap& placed_map() const { return color_map.name.empty() ? alpha_map : color_map; }
};

/// Returns materials by name. Keywords are not case-sensitive. If Kd has a single number, it applies to all three
/// colours. `d` has precedence over `Tr`. `Tr 1` without `d` means opaque, as in the programs that write it.
/// Lines that are not used are counted in `warnings`; the example is the file name and the line number.
std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                                            SourceWarnings& warnings);

/// A file name in an OBJ or MTL, and the path it resolves to. The file may be missing. The path is nullopt if it would
/// lie outside the folder of the source.
struct NamedFile {
  std::string name;
  std::optional<std::filesystem::path> file;

  bool is_there(const SourceFiles& files) const { return file && files.has(*file); }
};

/// Resolves a file name that occurs in `base`. If the path lies outside the folder of the source, only its last
/// component is used, in the folder of `base`. An example is an absolute path of another machine.
NamedFile named_file(const std::filesystem::path& base, std::string_view name, const SourceFiles& files);

/// Returns the files that an `mtllib` line of an OBJ names. If the rest of the line is the name of an existing file, it
/// is one name; otherwise each word is a name.
std::vector<NamedFile> material_files(const std::filesystem::path& file, const ObjLine& line, const SourceFiles& files);

}  // namespace gigabake
