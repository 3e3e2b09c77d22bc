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

/// Faces of any number of corners, negative indices, texture coordinates, vertex colours (sRGB, taken where all corners
/// of a material have them), groups (without meaning here), mtllib and usemtl; points and lines are counted.
/// Exact   Coordinates are read as doubles. Where some are beyond 10 km the middle of them all, in whole metres,
/// becomes
///         the instances' place, and what is left is rounded to floats: projected coordinates keep their millimetres.
/// Sink    A file of more than part_triangles() is read twice: to know what all corners of a material have, then to
/// hand
///         parts over as they are full. Its parts' vertices stand in the order of their first use, and where a file
///         changes from material to material a part may end before it is full.
/// Cost    The text is read in blocks, so it may be of any length. In memory: 24 bytes for each `v` of the file, 8 more
///         where it has colours, and 8 for each `vt`: 1.6 GB for the 5·10^7 vertices of 10^8 triangles. Without a sink
///         the mesh; with one two parts of part_triangles().
/// What a missing material file would describe is grey, unless it has vertex colours; a warning says so.
/// Errors  InputError with the line: an index that is none of the vertices', a number that is none, an image that is
///         missing.
TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink = nullptr);

/// Vertices at the beginning of an OBJ, of which `head` holds the first bytes; at most 64.
std::vector<Point<Local>> first_obj_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head);

/// Material files, there or missing, and images that the OBJ names, sorted. Errors  InputError as read_obj().
std::vector<std::filesystem::path> obj_dependencies(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
