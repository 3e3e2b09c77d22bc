/// What a bake reads: content files and where they stand in the scene.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/source/composite.h"
#include "format/source/mesh.h"
#include "lattice/frames.h"
#include "lattice/progress.h"
#include "lattice/rules.h"

namespace gigabake {

class Archive;
struct DemTile;

struct SourceOptions {
  bool local = false;              ///< no georeference even where the source has one
  std::optional<Geodetic> origin;  ///< scene origin; default: the source's own (see open_sources)
  std::optional<UpAxis> scene_up;  ///< the axis that points up in a tileset's own frame (default z) or in mesh
                                   ///< files (default y, as glTF has it)
};

enum class ContentKind : std::uint8_t { glb, gltf, b3dm, i3dm, obj, dem, ply, stl };
template <>
constexpr auto names_of<ContentKind>() {
  return std::to_array<std::string_view>({"glb", "gltf", "b3dm", "i3dm", "obj", "dem", "ply", "stl"});
}

/// One content file and its place. The same file may be placed several times.
struct TileRef {
  std::filesystem::path path;  ///< readable file inside the source folder
  std::string name;            ///< path relative to the source root, '/' separated, and "[i]" in a composite: messages
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;            ///< tileset's gltfUpAxis: how content turns to z up
  Affine<Scene, World> scene_from_tile;  ///< tile transforms, ECEF to scene, scene_up, all composed in double
  std::uint64_t bytes = 0;               ///< file size
  ByteRange range = {};                  ///< the tile's bytes in a composite; default: the whole file
  std::shared_ptr<const Archive> archive = nullptr;  ///< that `path` leads into, or none
  Affine<World, World> world_from_tile = {};     ///< the tileset's transforms alone: where an i3dm's east and north are
  std::shared_ptr<const DemTile> dem = nullptr;  ///< of ContentKind::dem: which cells of the raster
};

/// Something the source names and the bake does not have: missing file, unsupported kind. Costs exit code 3 unless
/// `informative` (pnts content, say: counted and reported, but no triangle is lost).
struct SkippedSource {
  std::string name;    ///< what it was
  std::string reason;  ///< one line
  bool informative = false;
  std::uint64_t points = 0;  ///< that it holds, of a point cloud
};

struct SceneSources {
  std::filesystem::path root;      ///< folder that bounds every URI
  std::vector<TileRef> tiles;      ///< in the source's own order; deterministic
  std::optional<Geodetic> origin;  ///< none: local scene
  std::vector<SkippedSource> skipped;
  std::vector<std::string> notes;  ///< what somebody should know of the sources' places; one line each
};

/// Reads what stands at `path`: a content file (docs/format-sources.md), a folder of them (sorted, not recursive into
/// symlinks), a 3D Tiles tileset .json (1.0 and 1.1) or its .3tz archive, or a scene .json of ours. Opens no mesh, but
/// looks where mesh files outside tilesets stand (format/source/earth_centred.h).
/// Georeference: a tileset whose root stands on the WGS84 earth, or a scene .json with lon/lat placements, gets the
/// ENU frame at `options.origin`, else at the root transform's translation (else its bounding volume's centre); mesh
/// files that hold earth-centred coordinates get it there or at the centre of their bounds.
/// With refine REPLACE the finest content is taken; where a finest content file is missing the nearest ancestor's
/// content stands in for it and the loss is listed in `skipped`.
/// Errors  InputError: unreadable, cyclic, malformed, URI leaving the root, unsupported required extension. Stopped.
SceneSources open_sources(const std::filesystem::path& path, const SourceOptions& options,
                          const Progress& progress = {});

enum class ReadScope : std::uint8_t { positions_only, everything };

/// Takes each primitive as soon as it is read, in the order of TileMesh::primitives; `index` is its place there.
using PrimitiveSink = std::function<void(std::size_t index, Primitive&& primitive)>;

/// Reads one content file. Hostile input is checked before any library sees it: nesting, sizes, URIs, views, accessors.
/// With a sink TileMesh::primitives keeps of each primitive its `material` and `position_step` alone, and a list that
/// is larger than a part (mesh_parts.h) comes as several primitives, each placed by Instances of its own. Exact   The
/// triangles, their order within a list, every value and the counts are the same with a sink and without. Errors
/// InputError naming file, key, byte offset, what was expected; names a required extension that we lack. With a
///         sink the same, perhaps after some primitives were handed over. What the sink throws passes through.
TileMesh read_tile(const TileRef& tile, const std::filesystem::path& root, ReadScope scope,
                   const PrimitiveSink& sink = nullptr);

}  // namespace gigabake
