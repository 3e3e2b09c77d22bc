/// `gigabake export --to dsm` and `--to ortho`: a scene seen from above, as a GeoTIFF.
#pragma once

#include <cstdint>
#include <string>

#include "app/options/area_options.h"
#include "query/maps/surface_map.h"

namespace gigabake::app {

struct MapExport {
  std::string scene, out;
  MapContent content = MapContent::heights;
  AreaOptions area;  ///< `crs` is also the coordinate system of the map
  int lod = 0;
  double step = 0;                                      ///< the edge of a pixel; 0: a voxel's edge at `lod`
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< 0: half of the host's memory
  int threads = 0;                                      ///< 0: all cores
  bool quiet = false;
};

/// Writes the file, and prints a line about its pixels. Returns the exit code.
/// Errors  UsageError, InputError. No file is left behind.
int export_map(const MapExport& options);

}  // namespace gigabake::app
