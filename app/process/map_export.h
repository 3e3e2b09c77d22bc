/// `gigabake export --to dsm`, `--to ortho` and `--to classes`: a scene seen from above, as a GeoTIFF.
#pragma once

#include <cstdint>
#include <string>

#include "app/options/area_options.h"
#include "cluster/mpi/mpi_session.h"
#include "query/maps/surface_map.h"

namespace gigabake::app {

struct MapExport {
  std::string scene, out;
  MapContent content = MapContent::heights;
  AreaOptions area;  ///< `crs` is also the coordinate system of the map
  int lod = 0;
  double step = 0;                                      ///< the edge of a pixel; 0: a voxel's edge at `lod`
  std::uint64_t memory_bytes = std::uint64_t(1) << 30;  ///< 0: half of the host's memory
  int threads = 0;                                      ///< of each rank; 0: the host's cores, divided among its ranks
  bool quiet = false;
};

/// Computes blocks of pixels on all ranks. Rank 0 writes the file, and prints a line about its pixels. Collective call.
/// Returns the exit code.
/// Errors  CollectiveUsageError, CollectiveFailure. No file is left behind.
int export_map(const MapExport& options, MpiSession& mpi);

}  // namespace gigabake::app
