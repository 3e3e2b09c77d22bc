/// Wavefront MTL: the materials of an OBJ file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/mesh/obj_lines.h"
#include "format/source/source_files.h"

namespace gigabake {

struct ObjMaterial {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< Kd and d, taken as linear; Kd is left out where there is a map
  std::string color_map, alpha_map;             ///< file names as written; empty: none
};

/// Materials by name. Errors  InputError with the line: a number that is none.
std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text);

/// Files that an OBJ names by `mtllib`: the whole rest of the line is one name where there is such a file, else each
/// word is one. They may be missing.
std::vector<std::filesystem::path> material_files(const std::filesystem::path& file, const ObjLine& line,
                                                  const SourceFiles& files);

/// The map's file. Errors  InputError: outside the source's folder, or missing.
std::filesystem::path map_file(const std::filesystem::path& mtl_file, const std::string& name,
                               const SourceFiles& files);

}  // namespace gigabake
