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
/// Range   The bounds fit if their centre is at a height of -12 km to 20 km and their half diagonal is less than 1000
///         km. Bounds of projected coordinates also fit near 57° of latitude (UTM) and in some zones (Gauss-Krüger).
///         Read as earth-centred, such projected coordinates are within 1 km south and 9 km north of the equator. If y
///         is up, they are on the meridian of Greenwich, in the southern sea.
EarthFit earth_fit(const WorldBox& bounds);

/// Returns the bounds that a content of 3D Tiles states, in its own frame, z up. They contain the bounds of the
/// accessors in glTF, or the positions of the instances in an i3dm.
/// Errors  InputError: a member that the bounds depend on is malformed.
WorldBox stated_bounds(const TileRef& tile, const SourceFiles& files);
/// Returns the bounds of all vertices in the frame of stated_bounds().
/// Range   scene_from_tile is the identity.
/// Errors  InputError like read_tile().
WorldBox vertex_bounds(const TileRef& tile, const std::filesystem::path& root);

/// Places earth-centred mesh files, which are not in a tileset, on the earth, as a tileset without transforms would.
/// The scene gets the origin of `options`, else the centre of all bounds. The up axis is that of `options`, else y in
/// glTF, and z in formats without such a convention. Earth-centred files that are not placed (options.local, possibly
/// projected) are reported in the sources' notes.
/// A file that cannot be read is skipped, because the scan reports it.
/// Cost    Reads the JSON of glTF, the feature tables of i3dm, and the first vertices of other formats. Reads all
///         vertices only if one of the first vertices is at the earth's surface.
/// Errors  InputError: some files are earth-centred and others are not.
void place_on_earth(const SourceOptions& options, SceneSources& sources);

}  // namespace gigabake
