/// STL as a tile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// ASCII and binary, which may begin with "solid" too: what is as long as its number of triangles says is binary.
/// Normals, names and attributes are not looked at; a loop of more than three corners is a polygon.
/// Sink    The file is read twice, in blocks: for the place of its origin, then to hand over parts as they are full.
/// Cost    With a sink one part and a block of the file; without one the mesh.
/// Exact   As OBJ (mesh_origin.h): the same numbers give the same vertices.
/// Errors  InputError with the line or the byte: a number that is none, a facet without three corners, a file that is
///         cut.
TileMesh read_stl(const TileRef& tile, const SourceFiles& files, const PrimitiveSink& sink = nullptr);

/// Vertices at the beginning of an STL of `file_bytes`, of which `head` holds the first; at most 64.
std::vector<Point<Local>> first_stl_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head,
                                             std::uint64_t file_bytes);

}  // namespace gigabake
