// read_tile(): whatever holds the tile, as triangles, materials and encoded images.
#include "format/content_container.h"
#include "format/dem_source.h"
#include "format/error.h"
#include "format/gltf_read.h"
#include "format/obj_read.h"

namespace gigabake {

TileMesh read_tile(const TileRef& tile, const std::filesystem::path& root, ReadScope scope) {
  try {
    if (tile.kind == ContentKind::obj) return read_obj(tile, files_of(tile, root), scope);
    if (tile.kind == ContentKind::dem) return read_dem_tile(tile, scope);
    return read_gltf(tile, root, scope);
  } catch (const std::bad_alloc&) {
    throw InputError(tile.path, "", "not enough memory to read this file");
  } catch (const nlohmann::json::exception& e) {
    throw InputError(tile.path, "", e.what());
  }
}

}  // namespace gigabake
