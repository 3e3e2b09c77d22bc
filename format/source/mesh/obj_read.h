/// Wavefront OBJ as a tile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Reads faces with negative indices, texture coordinates and vertex colours (sRGB), each used for the faces that have
/// it, mtllib and usemtl; points and lines are counted. docs/format-meshes.md lists what is used and reported.
/// Exact   Coordinates are read as doubles. Those beyond 10 km are stored relative to the origin of their group
///         (mesh_origin.h): projected coordinates keep their millimetres.
/// Sink    A file of more than part_triangles() is read twice: to know what all corners of a material have, then to
/// hand
///         parts over as they are full. Its parts' vertices stand in the order of their first use, and where a file
///         changes from material to material a part may end before it is full.
/// Cost    The text is read in blocks, so it may be of any length. In memory: 24 bytes for each `v` of the file, 8 more
///         where it has colours, and 8 for each `vt`: 1.6 GB for the 5·10^7 vertices of 10^8 triangles. Without a sink
///         the mesh; with one two parts of part_triangles().
/// What a missing material file would describe is grey, unless it has vertex colours; a warning says so.
/// Errors  InputError: no text, more vertices than 2^32 or than memory allows, a file that changes meanwhile.
TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink = nullptr);

/// Vertices at the beginning of an OBJ, of which `head` holds the first bytes; at most 64.
std::vector<Point<Local>> first_obj_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head);

/// Material files, there or missing, and images that the OBJ names, sorted. Errors  InputError as read_obj().
std::vector<std::filesystem::path> obj_dependencies(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
