/// Reader of STL files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Reads an STL file as a tile, in ASCII or binary. Binary files may also begin with "solid"; a file is binary if its
/// size matches the number of triangles in its header. Normals, names and attributes are ignored. A loop of more than
/// three corners is a polygon.
/// Sink    Full parts are passed to the sink.
/// Exact   The same numbers give the same vertices as in an OBJ (mesh_origin.h).
/// Cost    The file is read twice, in blocks: first to compute origins, then to read triangles. Memory: one part per
///         group of vertices and one block of the file if there is a sink, else the whole mesh.
/// Errors  InputError: the file is truncated or not an STL, has a facet of more than 2^20 corners, or changes while it
///         is read.
TileMesh read_stl(const TileRef& tile, const SourceFiles& files, const PrimitiveSink& sink = nullptr);

/// Returns at most 64 vertices from the beginning of an STL of `file_bytes` bytes. `head` holds its first bytes.
std::vector<Point<Local>> first_stl_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head,
                                             std::uint64_t file_bytes);

}  // namespace gigabake
