/// Detection of mesh files whose coordinates are earth-centred (WGS84, metres), which the files do not state.
#pragma once

#include "core/math/world_box.h"
#include "format/source/source.h"
#include "format/source/source_files.h"

namespace gigabake {

enum class EarthFit : std::uint8_t {
  none,
  surface,      ///< at the earth's surface, and small against the earth
  or_projected  ///< at the surface, but easting, northing and height of a projected system would have the same bounds
};

/// Classifies bounds of earth-centred coordinates by their distance from the surface of the WGS84 earth.
/// Range   A height of -12 km to 20 km, and up to 1000 km from the middle. Projected coordinates of some 57° of
///         latitude (UTM) or some zones (Gauss-Krüger) also fit. They would be points at the equator, 1 km south to 9
///         km north of it, or, if y is up, points of the meridian of Greenwich in the southern sea.
EarthFit earth_fit(const WorldBox& bounds);

/// Returns the bounds that a content of 3D Tiles states, in its own frame, z up. These are the accessors' bounds in
/// glTF, and the instances' places in an i3dm.
/// Errors  InputError: a member that the bounds depend on is malformed.
WorldBox stated_bounds(const TileRef& tile, const SourceFiles& files);
/// Returns the bounds of all vertices in the same frame.
/// Range   scene_from_tile is the identity.
/// Errors  as read_tile().
WorldBox vertex_bounds(const TileRef& tile, const std::filesystem::path& root);

/// Places earth-centred mesh files, which are not in a tileset, on the earth. They get the place that they would have
/// in a tileset without transforms. The scene gets the origin of `options`, else the centre of all bounds. The up axis
/// is that of `options`, else y in glTF, and z in formats without such a convention. Earth-centred files that are not
/// placed (options.local, possibly projected) are reported in the sources' notes.
/// Cost    Reads the JSON of glTF, the feature tables of i3dm, the first vertices of others. Reads all vertices only if
///         the first ones are at the earth's surface. A file that cannot be read is reported by the scan.
/// Errors  InputError: some files are earth-centred and others are not.
void place_on_earth(const SourceOptions& options, SceneSources& sources);

}  // namespace gigabake
