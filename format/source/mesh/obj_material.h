/// Wavefront MTL: the materials of an OBJ file.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source_files.h"

namespace gigabake {

struct ObjMaterial {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< Kd and d, taken as linear; Kd is left out where there is a map
  std::string color_map, alpha_map;             ///< file names as written; empty: none
};

/// A line of OBJ or MTL: its first word, and the rest without spaces around it.
struct ObjLine {
  std::size_t number = 0;
  std::string_view word, rest;
};

/// Visits the lines that are not empty and no comments; a backslash at the end joins the next one.
/// Errors  InputError: bytes of zero (UTF-16, binary).
void for_each_obj_line(const std::filesystem::path& file, std::span<const std::uint8_t> text,
                       const std::function<void(const ObjLine&)>& visit);

/// Of a file's beginning the lines that are there to their end.
std::span<const std::uint8_t> whole_lines(std::span<const std::uint8_t> head);

/// Materials by name. Errors  InputError with the line: a number that is none.
std::map<std::string, ObjMaterial> read_mtl(const std::filesystem::path& file, std::span<const std::uint8_t> text);

/// Files that an OBJ names by `mtllib`: the whole rest of the line is one name where there is such a file, else each
/// word is one. They may be missing.
std::vector<std::filesystem::path> material_files(const std::filesystem::path& file, const ObjLine& line,
                                                  const SourceFiles& files);

/// The map's file. Errors  InputError: outside the source's folder, or missing.
std::filesystem::path map_file(const std::filesystem::path& mtl_file, const std::string& name,
                               const SourceFiles& files);

/// Leading numbers of `text`; stops at the first word that is none. Exact  the nearest double.
std::vector<double> obj_numbers(std::string_view text, std::size_t most);

}  // namespace gigabake
