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
#include "core/base/thread_pool.h"
#include "core/math/frames.h"
#include "format/source/mesh.h"

namespace gigabake {

class Archive;
struct Area;
struct DemTile;
struct Edit;
struct NamedVoxelSizes;
struct SourceClasses;
struct SourceEdits;
struct NamedSourceEdit;

/// Statements about the elevation rasters of a source. A scene .json has its own statements per raster.
struct RasterOptions {
  std::filesystem::path ortho;           ///< image with their colours; empty: none
  std::string dem_crs;                   ///< in place of their coordinate system; empty: their own
  std::vector<double> nodata;            ///< numbers that mark missing heights; empty: those that the rasters declare
  std::optional<double> geoid_offset_m;  ///< in place of their vertical reference system
  friend bool operator==(const RasterOptions&, const RasterOptions&) = default;
};

struct SourceOptions {
  bool local = false;              ///< no georeference even if the source has one
  std::optional<Geodetic> origin;  ///< scene origin; default: the source's own (see open_sources)
  std::optional<UpAxis> scene_up;  ///< up axis in a tileset's own frame (default z) or in mesh files (default y, as in
                                   ///< glTF)
  std::shared_ptr<const Area> area = nullptr;                ///< the part of the source that is used; null: all of it
  RasterOptions raster = {};                                 ///< for a source that consists of elevation rasters
  std::shared_ptr<const std::vector<Edit>> edits = nullptr;  ///< applied after the edits of the source; null: none
  /// Edits of sources, applied after the edits in a scene .json; null: none.
  std::shared_ptr<const std::vector<NamedSourceEdit>> source_edits = nullptr;
};

enum class ContentKind : std::uint8_t { glb, gltf, b3dm, i3dm, obj, dem, ply, stl };
template <>
constexpr auto names_of<ContentKind>() {
  return std::to_array<std::string_view>({"glb", "gltf", "b3dm", "i3dm", "obj", "dem", "ply", "stl"});
}

/// The bytes [begin, end) of a file. If `end` is 0, the range extends to the end of the file.
struct ByteRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// The voxel size that a scene .json states for a source, or for a name in it.
struct SourceVoxelSize {
  std::filesystem::path file;  ///< scene .json
  std::string key;             ///< the key in it
  double metres = 0;
};

/// One content file, or a part of one, and its placement in the scene. Several tiles may place the same file.
struct TileRef {
  std::filesystem::path path;  ///< readable file inside the source folder
  std::string name;            ///< for messages: path relative to the root, '/' separated, with "[i]" in a composite
  ContentKind kind = ContentKind::glb;
  UpAxis gltf_up = UpAxis::y;                        ///< up axis of the content, such as a tileset's gltfUpAxis
  Affine<Scene, World> scene_from_tile;              ///< from the tile's frame, rotated to z up, to the scene
  std::uint64_t bytes = 0;                           ///< file size; for a raster, its size divided by the number of
                                                     ///< tiles
  ByteRange range = {};                              ///< the bytes of a tile in a composite; by default the whole file
  std::shared_ptr<const Archive> archive = nullptr;  ///< the archive that contains the file, or null
  Affine<World, World> world_from_tile = {};         ///< the tileset's transforms only; an i3dm needs them to find east
                                                     ///< and north
  std::shared_ptr<const DemTile> dem = nullptr;      ///< cells of a raster; null for other formats
  std::shared_ptr<const SourceEdits> edits = nullptr;            ///< edits of the tile's triangles; null: none
  std::shared_ptr<const SourceVoxelSize> voxel_size = nullptr;   ///< null: that of the scene
  std::shared_ptr<const NamedVoxelSizes> named_sizes = nullptr;  ///< of materials and nodes; null: none
  std::shared_ptr<const SourceClasses> classes = nullptr;        ///< null: the source states no classes
  std::uint8_t lod =
      0;  ///< level at which its triangles are voxelized; see set_source_levels() (source_levels.h) and lod_of()
};

/// An input that the source names but the bake cannot use: a missing file, an unsupported format. The exit status is 3
/// unless the input is `informative`. An informative input, such as a point cloud, is reported, but has no triangles.
struct SkippedSource {
  std::string name;    ///< file, or file and key
  std::string reason;  ///< one line
  bool informative = false;
  std::uint64_t points = 0;  ///< number of points in a point cloud
};

struct SceneSources {
  std::filesystem::path root;      ///< no URI may lead out of this folder
  std::vector<TileRef> tiles;      ///< in the source's own order; deterministic
  std::optional<Geodetic> origin;  ///< nullopt if the scene is local
  std::vector<SkippedSource> skipped;
  std::vector<std::string> notes;              ///< information on the sources' places for the user; one line each
  std::shared_ptr<const Area> area = nullptr;  ///< SourceOptions::area
  std::shared_ptr<const std::vector<Edit>> edits = nullptr;  ///< edits of the scene, in their order; null: none
  bool is_scene_json = false;                                ///< a scene .json lists the sources
  std::uint64_t outside = 0;  ///< known content files that were not opened, because they lie outside the area
};

/// Opens the source at `path`: a content file (docs/format-sources.md), a folder of content files, a tileset or a
/// scene. The files of a folder are sorted; symbolic links to folders are not followed. A tileset is a 3D Tiles .json
/// (1.0 and 1.1) or its .3tz archive; a scene is a gigabake scene .json. Reads bounds, and in rare cases vertices, to
/// locate content on the earth (earth_centred.h, tileset_place.h).
/// The scene gets an east-north-up frame if a source has a place on the WGS84 earth. These sources are tilesets,
/// rasters, mesh files with earth-centred coordinates, and scenes with lon/lat placements. The origin of the frame is
/// `options.origin`, else the place of the source. The place of a tileset is the translation of the root transform,
/// else the centre of the root's bounding volume. The place of mesh files is the centre of their bounds.
/// If tiles refine by REPLACE, the finest content is used. If a finest content file is missing, the nearest ancestor's
/// content replaces it, and the missing file is listed in `skipped`.
/// If there is an area, omits all tiles whose bounds lie outside it, without opening their files. Only mesh files state
/// their bounds inside; their headers are read.
/// Errors  InputError: a source is unreadable, cyclic or malformed, a URI leads out of the root, or a required
///         extension is not supported. UsageError: the area lies on the earth and the scene does not, no tile lies in
///         the area, or `raster` is stated for another source. Stopped: the caller cancelled the step.
SceneSources open_sources(const std::filesystem::path& path, const SourceOptions& options,
                          const Progress& progress = {});

enum class ReadScope : std::uint8_t { positions_only, without_normals, everything };

/// A callback that receives each primitive after it is read, in the order of TileMesh::primitives. `index` is the index
/// of the primitive in TileMesh::primitives.
using PrimitiveSink = std::function<void(std::size_t index, Primitive&& primitive)>;

/// Reads one content file. Untrusted input is checked before any library reads it: nesting, sizes, URIs, views,
/// accessors. If a sink is given, TileMesh::primitives keeps only `material` and `position_step` of each primitive. A
/// triangle list that is too large for one part (mesh_parts.h) becomes several primitives, each with its own Instances.
/// The threads of `pool` read the parts of a glTF primitive, as many at once as memory_limit() permits.
/// Exact   The triangles, their order within a list, every value and the counts are the same with a sink and without.
/// Errors  InputError names the file, the key, the byte offset and the expected value, or the required extension that
///         is not supported. A sink may have received some primitives before the error. Exceptions of the sink are
///         passed through.
TileMesh read_tile(const TileRef& tile, const std::filesystem::path& root, ReadScope scope,
                   const PrimitiveSink& sink = nullptr, const ThreadPool& pool = callers_thread());

}  // namespace gigabake
