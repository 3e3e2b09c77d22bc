/// Sources of a bake: content files and their positions in the scene.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/rules.h"
#include "core/math/frames.h"
#include "format/source/mesh.h"

namespace gigabake {

class Archive;
struct DemTile;

struct SourceOptions {
  bool local = false;              ///< no georeference even if the source has one
  std::optional<Geodetic> origin;  ///< scene origin; default: the source's own (see open_sources)
  std::optional<UpAxis> scene_up;  ///< up axis in a tileset's own frame (default z) or in mesh files (default y, as
                                   ///< glTF has it)
};

enum class ContentKind : std::uint8_t { glb, gltf, b3dm, i3dm, obj, dem, ply, stl };
template <>
constexpr auto names_of<ContentKind>() {
  return std::to_array<std::string_view>({"glb", "gltf", "b3dm", "i3dm", "obj", "dem", "ply", "stl"});
}

/// Bytes [begin, end) of a file; end 0: the whole file.
struct ByteRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// One content file and its place. The same file may be placed several times.
struct TileRef {
  std::filesystem::path path;  ///< readable file inside the source folder
  std::string name;            ///< path relative to the source root, '/' separated, and "[i]" in a composite: messages
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;                        ///< tileset's gltfUpAxis: axis of the content that becomes z
  Affine<Scene, World> scene_from_tile;              ///< product of tile transforms, ECEF to scene, scene_up, in double
  std::uint64_t bytes = 0;                           ///< file size
  ByteRange range = {};                              ///< the tile's bytes in a composite; default: the whole file
  std::shared_ptr<const Archive> archive = nullptr;  ///< archive that `path` leads into, or none
  Affine<World, World> world_from_tile = {};         ///< only the tileset's transforms, for east and north of an i3dm
  std::shared_ptr<const DemTile> dem = nullptr;      ///< of ContentKind::dem: cells of the raster
};

/// An input that the source names but the bake cannot use: a missing file, an unsupported format. The exit code is 3
/// unless it is `informative`, such as a point cloud: it is counted and reported, but no triangle is missing.
struct SkippedSource {
  std::string name;    ///< file, or file and key
  std::string reason;  ///< one line
  bool informative = false;
  std::uint64_t points = 0;  ///< of a point cloud
};

struct SceneSources {
  std::filesystem::path root;      ///< folder that bounds every URI
  std::vector<TileRef> tiles;      ///< in the source's own order; deterministic
  std::optional<Geodetic> origin;  ///< none: local scene
  std::vector<SkippedSource> skipped;
  std::vector<std::string> notes;  ///< information on the sources' places for the user; one line each
};

/// Opens the source at `path`: a content file (docs/format-sources.md), a folder of content files, a tileset or a
/// scene. The files of a folder are sorted; symbolic links to folders are not followed. A tileset is a 3D Tiles .json
/// (1.0 and 1.1) or its .3tz archive; a scene is a gigabake scene .json. Opens no mesh, but reads bounds of mesh files
/// outside tilesets (format/source/earth_centred.h).
/// Georeference: the scene gets an ENU frame if a tileset's root is on the WGS84 earth, or if a scene .json has lon/lat
/// placements. Its origin is `options.origin`, else the root transform's translation, else the centre of the root's
/// bounding volume. Mesh files with earth-centred coordinates get it at `options.origin` or at the centre of their
/// bounds.
/// If tiles refine by REPLACE, the finest content is used. If a finest content file is missing, the nearest ancestor's
/// content replaces it, and the missing file is listed in `skipped`.
/// Errors  InputError: unreadable, cyclic, malformed, URI leaving the root, unsupported required extension. Stopped.
SceneSources open_sources(const std::filesystem::path& path, const SourceOptions& options,
                          const Progress& progress = {});

enum class ReadScope : std::uint8_t { positions_only, everything };

/// Receives each primitive once it is read, in the order of TileMesh::primitives; `index` is its index in that list.
using PrimitiveSink = std::function<void(std::size_t index, Primitive&& primitive)>;

/// Reads one content file. Untrusted input is checked before any library reads it: nesting, sizes, URIs, views,
/// accessors. If a sink is given, TileMesh::primitives keeps only `material` and `position_step` of each primitive. A
/// list larger than a part (mesh_parts.h) is passed on as several primitives, each placed by separate Instances.
/// Exact   The triangles, their order within a list, every value and the counts are the same with a sink and without.
/// Errors  InputError with file, key, byte offset and expected value; names a required extension that is not supported.
///         If a sink is given, it may have received some primitives before. Exceptions of the sink are passed through.
TileMesh read_tile(const TileRef& tile, const std::filesystem::path& root, ReadScope scope,
                   const PrimitiveSink& sink = nullptr);

}  // namespace gigabake
