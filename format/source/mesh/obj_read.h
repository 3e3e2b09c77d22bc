/// Reader of Wavefront OBJ files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Reads an OBJ file as a tile. Reads faces, negative indices, texture coordinates, vertex colours (sRGB), mtllib and
/// usemtl. Texture coordinates and colours apply to faces whose corners all have them. Points and lines are counted.
/// docs/format-meshes.md lists the keywords that are used and reported.
/// Faces without vertex colours are grey if their material is missing; a warning reports missing material files.
/// Sink    A file of more than part_triangles() triangles is read twice. The first pass finds the attributes of all
///         materials; the second passes parts to the sink. A part's vertices are in the order of their first use. If
///         the material changes often, a part may end before it is full.
/// Exact   Coordinates are read as doubles. Coordinates beyond 10 km are stored relative to the origin of their group
///         (mesh_origin.h), so projected coordinates keep a precision of millimetres.
/// Cost    The text is read in blocks, so its length is not limited. Memory: 24 bytes per `v`, 8 more in files with
///         colours, and 8 per `vt`: 1.6 GB for the 5·10^7 vertices of 10^8 triangles. The whole mesh is also in memory,
///         or two parts of part_triangles() if there is a sink.
/// Errors  InputError: the file is not text, has more vertices than 2^32 or than fit into memory, or changes while it
///         is read.
TileMesh read_obj(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink = nullptr);

/// Returns at most 64 vertices from the beginning of an OBJ. `head` holds the first bytes of the file.
std::vector<Point<Local>> first_obj_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head);

/// Returns the sorted paths of material files and images that the OBJ names, existing or missing.
/// Errors  InputError like read_obj().
std::vector<std::filesystem::path> obj_dependencies(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
