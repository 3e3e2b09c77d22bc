/// Mesh files whose coordinates are earth-centred (WGS84, metres), though nothing in them says so.
#pragma once

#include "format/source/source.h"
#include "format/source/source_files.h"
#include "lattice/world_box.h"

namespace gigabake {

enum class EarthFit : std::uint8_t {
  none,
  surface,      ///< at the earth's surface, and small against the earth
  or_projected  ///< likewise, but easting, northing and height of a projected system would look the same
};

/// Do these bounds, taken as earth-centred coordinates, lie at the surface of the WGS84 earth?
/// Range   From 12 km below the ellipsoid to 20 km above, and up to 1000 km from the middle. Projected coordinates of
///         some 57° of latitude (UTM) or some zones (Gauss-Krüger) would be points at the equator between 1 km south
///         and 9 km north of it, or with y up points of the meridian of Greenwich in the southern sea.
EarthFit earth_fit(const WorldBox& bounds);

/// Returns the bounds that a content of 3D Tiles states, in its own frame, z up: of glTF those of its accessors, of an
/// i3dm the places of its instances.
/// Errors  InputError: what it reads of the file is malformed.
WorldBox stated_bounds(const TileRef& tile, const SourceFiles& files);
/// Returns the bounds of all vertices in the same frame.  Range  scene_from_tile is the identity.
/// Errors  as read_tile().
WorldBox vertex_bounds(const TileRef& tile, const std::filesystem::path& root);

/// Of sources that are mesh files, each alone or in a folder, not yet placed: where they are earth-centred, they get
/// the place that they would have as content of a tileset without transforms, and the scene its origin: `options`', or
/// the centre of all bounds. The axis that points up is the one of `options`, else glTF's y, and z in formats without
/// such a convention. What is earth-centred and not used so (options.local, too near to a projected system) is noted.
/// Cost    Reads the JSON of glTF, the feature tables of i3dm, the first vertices of others; all of these only where
///         they are at the earth's surface. A file that cannot be read is left to the survey.
/// Errors  InputError: some files are earth-centred and others are not.
void place_on_earth(const SourceOptions& options, SceneSources& sources);

}  // namespace gigabake
