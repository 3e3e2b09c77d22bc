// Warnings about declarations in the header of a PLY that the reader does not use.
#include <algorithm>
#include <set>
#include <string_view>

#include "core/base/error.h"
#include "format/source/image/image_file.h"
#include "format/source/mesh/obj_material.h"
#include "format/source/mesh/ply_layout.h"

namespace gigabake {
namespace {

bool is_used_of_faces(std::string_view name) {
  static const std::set<std::string_view> names{"vertex_indices", "vertex_index", "texcoord", "texnumber"};
  return names.count(name) != 0;
}

/// Returns whether a property is irrelevant for surfaces, for example the normal of a face or the accuracy of a
/// scanner.
bool is_without_meaning(std::string_view name) {
  static const std::set<std::string_view> names{"nx",    "ny",      "nz",        "confidence", "intensity",
                                                "flags", "quality", "curvature", "radius",     "material_index"};
  return names.count(name) != 0;
}

void warn_of_properties(const PlyElement& e, bool has_vertex_colour, SourceWarnings& warnings) {
  const VertexLayout layout(e);
  std::set<std::size_t> used;
  for (const auto& index : layout.position) used.insert(index.value_or(e.properties.size()));
  for (const auto& index : layout.colour) used.insert(index.value_or(e.properties.size()));
  for (const auto& index : layout.uv) used.insert(index.value_or(e.properties.size()));
  if (e.name == "face" && has_vertex_colour && layout.has_colour())
    warnings.count("colours of faces are not used, since vertices have some", in_quotes("red"));
  for (std::size_t i = 0; i < e.properties.size(); ++i) {
    const std::string& name = e.properties[i].name;
    const bool is_used = used.count(i) != 0 || (e.name != "vertex" && is_used_of_faces(name));
    if (!is_used && !is_without_meaning(name)) warnings.count("properties that are not used", in_quotes(name));
  }
}

bool has_texture_coordinates(const PlyHeader& header) {
  return std::any_of(header.elements.begin(), header.elements.end(), [](const PlyElement& e) {
    return e.name == "vertex" ? VertexLayout(e).has_uv() : e.find({"texcoord"}).has_value();
  });
}

}  // namespace

std::optional<std::filesystem::path> ply_image(const TileRef& tile, const SourceFiles& files, const std::string& name) {
  const NamedFile image = named_file(tile.path, name, files);
  return image.is_there(files) && is_image_file(files, *image.file) ? image.file : std::nullopt;
}

void warn_of_header(const TileRef& tile, const SourceFiles& files, const PlyHeader& header, SourceWarnings& warnings) {
  for (const std::string& name : header.textures) {
    if (ply_image(tile, files, name)) continue;
    const bool is_there = named_file(tile.path, name, files).is_there(files);
    warnings.count(is_there ? "images are not PNG, JPEG or WebP: ignored" : "images are missing: ignored",
                   in_quotes(name));
  }
  const bool has_uv = has_texture_coordinates(header);
  if (has_uv && header.textures.empty())
    warnings.count("texture coordinates without an image", in_quotes("TextureFile"));
  if (!has_uv && !header.textures.empty())
    warnings.count("images without texture coordinates", in_quotes(header.textures[0]));
  bool has_vertex_colour = false;
  for (const PlyElement& e : header.elements) has_vertex_colour |= e.name == "vertex" && VertexLayout(e).has_colour();
  for (const PlyElement& e : header.elements)
    if (e.name == "vertex" || e.name == "face" || e.name == "tristrips")
      warn_of_properties(e, has_vertex_colour, warnings);
    else if (e.count != 0)
      warnings.count("elements that are not read", in_quotes(e.name));
}

}  // namespace gigabake
