/// Parallel scan of tiles: every rank's bake process scans a part of the tiles, and rank 0 collects the results.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "cluster/mpi/mpi_session.h"
#include "cluster/process/bake_process.h"
#include "format/job/tile_scan.h"

namespace gigabake {

/// Scans tiles in the rank's own bake process. If the process dies, each tile that was in flight is retried in
/// isolation. A tile that fails three isolated attempts gets a scan result whose error states how the process ended.
/// The callback `each` receives each result, and `died` the reason of a death. The callback `idle` is called at least
/// every few milliseconds and returns false to stop the scan.
/// Errors  std::runtime_error: the process ends repeatedly before it has started.
void scan_on_this_rank(BakeProcess& process, const std::vector<std::uint32_t>& tiles,
                       const std::function<void(TileScan)>& each, const std::function<void(const std::string&)>& died,
                       const std::function<bool()>& idle);

/// Callbacks of rank 0 during the scan.
struct ScanListener {
  /// Receives the number of results; returns false to stop all ranks.
  std::function<bool(std::size_t)> scanned;
  std::function<void(int rank, const std::string&)> died;  ///< receives a rank whose bake process ended, and the reason
};

/// Collective call. Returns one result per tile on rank 0, none elsewhere; only rank 0's `tiles` are used. A tile that
/// cannot be read has a result with an error. `heartbeat_timeout_s` is rank 0's heartbeat timeout for other ranks. The
/// listener is used on rank 0; if it stops the scan, the results obtained until then are returned.
/// Errors  RankLost on rank 0: a rank's heartbeat timed out. No collective call may follow.
std::vector<TileScan> scan_tiles(MpiSession& mpi, const std::vector<std::uint32_t>& tiles, BakeProcess& process,
                                 double heartbeat_timeout_s, const ScanListener& listener);

}  // namespace gigabake
