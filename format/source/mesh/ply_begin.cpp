// Reads the parts of a PLY that are needed before its mesh: the first vertices and the names of images.
#include <algorithm>

#include "core/base/error.h"
#include "format/source/content/content_pieces.h"
#include "format/source/mesh/mesh_origin.h"
#include "format/source/mesh/obj_material.h"
#include "format/source/mesh/ply_layout.h"
#include "format/source/mesh/ply_read.h"
#include "format/source/mesh/ply_values.h"
#include "format/source/source_file.h"

namespace gigabake {

std::vector<Point<Local>> first_ply_vertices(const std::filesystem::path& file, std::span<const std::uint8_t> head) {
  const PlyHeader header = read_ply_header(file, head);
  PlyValues values(file, SourceBytes({head.begin(), head.end()}), header);
  std::vector<Point<Local>> out;
  for (const PlyElement& e : header.elements) {
    if (e.properties.empty()) continue;
    const VertexLayout layout(e);
    std::vector<double> value(e.properties.size());
    for (std::uint64_t i = 0; i < std::min<std::uint64_t>(e.count, max_first_vertices); ++i) {
      for (std::size_t p = 0; p < value.size(); ++p)
        if (e.properties[p].count)
          values.skip(e.properties[p]);
        else
          value[p] = values.number(e.properties[p].type);
      if (layout.has_position())
        out.push_back({value[*layout.position[0]], value[*layout.position[1]], value[*layout.position[2]]});
    }
    if (!out.empty() || e.count > max_first_vertices) break;  // in almost all files the vertices are the first element
  }
  return out;
}

std::vector<std::filesystem::path> ply_dependencies(const TileRef& tile, const SourceFiles& files) {
  ContentPieces pieces(tile, files);
  std::vector<std::filesystem::path> out;
  for (const std::string& name : read_ply_header(tile.path, pieces.read(0, max_ply_header_bytes)).textures)
    if (const NamedFile image = named_file(tile.path, name, files); image.file) out.push_back(*image.file);
  return out;
}

}  // namespace gigabake
