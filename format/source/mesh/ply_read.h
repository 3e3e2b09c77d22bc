/// PLY meshes as a tile. (format/export/ply.h writes voxels as such a file.)
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// ASCII and binary of either byte order. Vertices: x y z; red green blue alpha (sRGB; integers against the largest of
/// their type); u v, s t or texture_u texture_v. Faces: vertex_indices or vertex_index, of any number of corners;
/// texcoord, the corners' own texture coordinates, and texnumber, as MeshLab writes them beside "comment TextureFile".
/// Triangle strips: "tristrips". Everything else is read over. Without a face all vertices are points and counted; a
/// face of two corners is a line.
/// Sink    Parts are handed over as they are full, if the vertices stand before the faces, as in nearly every file.
/// Cost    The file is read in blocks. In memory: 24 bytes per vertex, 8 more each for colours and texture coordinates,
/// 4
///         per vertex and texture. Without a sink, or with faces first, the mesh too; else two parts.
/// Exact   As OBJ (mesh_origin.h): the same numbers give the same vertices.
/// Errors  InputError with the line or the byte: a malformed header, elements that the file has no room for, an index
///         that is none of the vertices', a file that ends early, more than memory_limit() allows.
TileMesh read_ply(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink = nullptr);

/// Vertices at the beginning of a PLY, of which `head` holds the first bytes; at most 64.
std::vector<Point<Local>> first_ply_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head);

/// Images that it names, whether they are there or not. Errors  InputError: the header.
std::vector<std::filesystem::path> ply_dependencies(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
