/// Elevation rasters as terrain: two triangles a cell, in tiles, an orthophoto on them.
///
/// A vertex is a pixel's centre, its place by the raster's coordinate system and WGS84. Cells with a corner that has no
/// value are holes. The diagonal goes from the first corner (lowest row and column) to the last.
/// Exact   All tiles of a raster share one frame and one grid of places, 2^-10 m apart, so that neighbours share their
///         vertices to the bit.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "format/source/mesh.h"
#include "lattice/frames.h"

namespace gigabake {

/// What a scene file says of a raster; members as its keys.
struct DemOptions {
  std::filesystem::path dem, ortho;      ///< ortho may be empty
  std::string crs;                       ///< in place of the raster's own: "EPSG:25832", WKT or a PROJ text
  std::optional<double> nodata;          ///< in place of the raster's own
  std::optional<double> height_scale;    ///< metres a unit; else what the raster says
  std::optional<double> geoid_offset_m;  ///< added to heights: the geoid above the ellipsoid; unset: 0
  int tile_cells = 256;                  ///< edge of a tile
};

struct DemRaster {
  DemOptions options;
  int columns = 0, rows = 0;  ///< pixels
  Geodetic origin;            ///< the middle of the raster, on the ellipsoid: east-north-up there is the raster's frame
  std::vector<std::string> warnings;  ///< what the raster says and is not used; one line each, without its name.
                                      ///< Of the rank that opened it
};

/// A rectangle of cells.
struct DemTile {
  std::shared_ptr<const DemRaster> raster;
  int column = 0, row = 0, columns = 0, rows = 0;
  std::array<double, 3> offset_m{};  ///< of the tile's own frame in the raster's: whole metres
};

/// Reads the raster's head, and elevation only where it is refused. Formats: GeoTIFF (COG), ASCII grid, SRTM HGT, PNG
/// and JPEG with a world file. Errors  InputError naming the key of the scene file to set: a coordinate system that is
/// missing, unknown, not on the
///         earth, or that the raster's numbers do not fit; an image in place of heights; no raster; built without GDAL.
std::vector<DemTile> open_dem(const DemOptions& options);

/// One primitive in the tile's own frame (z up), one instance there; the orthophoto's part as an image.
/// Cost    Reads the tile's window of both rasters, whatever their size.
/// Errors  InputError: what cannot be read.
struct DemMesh {
  Primitive primitive;
  Material material;
  std::vector<EncodedImage> images;   ///< one or none
  std::vector<std::string> warnings;  ///< of this tile's heights; one line each, without the raster's name
};
DemMesh read_dem(const DemTile& tile, bool with_ortho);

/// The rasters' files, with those that stand beside them and belong to them.
std::vector<std::filesystem::path> dem_files(const DemOptions& options);

}  // namespace gigabake
