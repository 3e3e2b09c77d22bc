/// The sources of a bake on all ranks: rank 0 opens them once, and every rank's bake process receives the result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "cluster/mpi/mpi_session.h"
#include "core/base/progress.h"
#include "core/octree/parameters.h"
#include "format/source/source.h"

namespace gigabake {

struct SharedSources {
  SceneSources scene;                                      ///< on rank 0 only; empty elsewhere
  BakeParameters parameters;                               ///< with the levels of the sources, on every rank
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;  ///< format/job/source_bytes.h, on every rank
};

/// Collective. Rank 0 opens the source and sends heartbeats to the other ranks during that time. It sets the levels of
/// the sources (format/source/levels/source_levels.h), which may change the parameters.
/// Errors  CollectiveUsageError: the area does not fit the source, or a source has a wrong voxel size.
///         CollectiveFailure: another error of open_sources() on rank 0, or another rank does not see the path.
///         Stopped: a stop was requested on rank 0. RankLost: no message from rank 0 within the timeout of a collective
///         call.
SharedSources open_shared_sources(MpiSession& mpi, const std::filesystem::path& path, const SourceOptions& options,
                                  const BakeParameters& parameters, const Progress& progress);

}  // namespace gigabake
