#include "format/source/tiles/tileset_head.h"

#include <set>
#include <string>

#include "core/base/error.h"

namespace gigabake {

UpAxis tileset_up_axis(const JsonMembers& asset) {
  const std::string up = asset.find<std::string>("gltfUpAxis").value_or("Y");
  if (up == "X" || up == "x") return UpAxis::x;
  if (up == "Z" || up == "z") return UpAxis::z;
  if (up == "Y" || up == "y") return UpAxis::y;
  asset.fail("gltfUpAxis", "expected X, Y or Z, got " + in_quotes(up));
}

void check_tileset_head(const std::filesystem::path& file, const TilesetDocument& document) {
  const JsonMembers json(file, document.json), asset = json.members("asset");
  const std::string version = asset.find<std::string>("version").value_or("");
  static const std::set<std::string> versions{"0.0", "1.0", "1.1"};  // and "1.0.0"
  if (!versions.contains(version.substr(0, 3)) || (version.size() > 3 && version[3] != '.'))
    asset.fail("version", "expected 3D Tiles 1.0 or 1.1, got " + in_quotes(version));
  static const std::set<std::string> known{
      "3DTILES_content_gltf",       "3DTILES_multiple_contents",     "3DTILES_implicit_tiling", "3DTILES_metadata",
      "3DTILES_bounding_volume_S2", "3DTILES_batch_table_hierarchy", "MAXAR_content_3tz"};
  for (const Json& e : json.array("extensionsRequired")) {
    const std::string name = e.is_string() ? e.get<std::string>() : "(not a string)";
    if (!known.contains(name))
      json.fail("extensionsRequired", "the extension " + in_quotes(name) + " is not supported");
  }
  if (!document.root) throw InputError(file, "root", "is missing");
  if (document.root->fault) throw InputError(file, "", *document.root->fault);
  tileset_up_axis(asset);
}

}  // namespace gigabake
