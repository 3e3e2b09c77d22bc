/// Reader of PLY meshes. (format/export/ply/ply.h writes voxels as a PLY file.)
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/mesh.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

/// Reads a PLY file as a tile, in ASCII or binary of either byte order.
/// Vertices have the properties x y z; red green blue alpha; u v, s t or texture_u texture_v. Colours are sRGB;
/// integers are divided by the max value of their type.
/// Faces have the property vertex_indices or vertex_index, with any number of corners. They may have texture
/// coordinates per corner (`texcoord`) and the number of an image (`texnumber`). MeshLab writes both with "comment
/// TextureFile".
/// The element "tristrips" has triangle strips. All other elements and properties are skipped. If a file has no faces,
/// its vertices are counted as points. A face of two corners is counted as a line.
/// Sink    Parts are passed to the sink when they are full, if the vertices precede the faces, as in almost all files.
/// Exact   The same numbers give the same vertices as in an OBJ (mesh_origin.h).
/// Cost    The file is read in blocks. Memory: 24 bytes per vertex, 8 more each for colours and texture coordinates, 4
///         per vertex and texture. The whole mesh is also in memory if there is no sink or faces precede the vertices,
///         else two parts.
/// Errors  InputError with the line or the byte: the header is malformed, the file ends early or cannot hold the
///         declared elements, or the memory exceeds memory_limit().
TileMesh read_ply(const TileRef& tile, const SourceFiles& files, ReadScope scope, const PrimitiveSink& sink = nullptr);

/// Returns at most 64 vertices from the beginning of a PLY. `head` holds the first bytes of the file.
std::vector<Point<Local>> first_ply_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head);

/// Returns the paths of images that the PLY names, existing or missing.
/// Errors  InputError: the header is malformed.
std::vector<std::filesystem::path> ply_dependencies(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
