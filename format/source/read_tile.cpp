// read_tile(): reads a tile of any format as triangles, materials and encoded images.
#include <exception>

#include "core/base/error.h"
#include "format/source/classes/source_classes.h"
#include "format/source/content/content_container.h"
#include "format/source/gltf/read.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/mesh/obj_read.h"
#include "format/source/mesh/ply_read.h"
#include "format/source/mesh/stl_read.h"
#include "format/source/mesh_parts.h"
#include "format/source/raster/dem_source.h"

namespace gigabake {

namespace {

bool holds_gltf(ContentKind kind) {
  return kind == ContentKind::glb || kind == ContentKind::gltf || kind == ContentKind::b3dm ||
         kind == ContentKind::i3dm;
}

/// An exception of a sink, wrapped so that the handlers of read errors do not catch it.
struct SinkFailure {
  std::exception_ptr error;
};

}  // namespace

TileMesh read_tile(const TileRef& tile, const std::filesystem::path& root, ReadScope scope, const PrimitiveSink& sink,
                   const ThreadPool& pool) {
  const PrimitiveSink guarded = [&sink](std::size_t index, Primitive&& primitive) {
    try {
      sink(index, std::move(primitive));
    } catch (...) {
      throw SinkFailure{std::current_exception()};
    }
  };
  try {
    if (holds_gltf(tile.kind)) return read_gltf(tile, root, scope, sink ? guarded : sink, pool);
    expect_no_ids(tile);
    if (tile.kind == ContentKind::obj) return read_obj(tile, files_of(tile, root), scope, sink ? guarded : sink);
    expect_no_nodes(tile);
    if (tile.kind == ContentKind::ply) return read_ply(tile, files_of(tile, root), scope, sink ? guarded : sink);
    if (tile.kind == ContentKind::stl) return read_stl(tile, files_of(tile, root), sink ? guarded : sink);
    TileMesh mesh = read_dem_tile(tile, scope);
    if (sink) pass_on_parts(mesh, guarded);
    return mesh;
  } catch (const SinkFailure& failure) {
    std::rethrow_exception(failure.error);
  } catch (const std::bad_alloc&) {
    throw InputError(tile.path, "", not_enough_memory);
  } catch (const nlohmann::json::exception&) {
    throw InputError(tile.path, "", "a member of its JSON has another type than glTF gives it");
  }
}

}  // namespace gigabake
