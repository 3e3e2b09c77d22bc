/// The sources of a bake on all ranks: rank 0 opens them once, and every rank's bake process gets what it found.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "cluster/mpi_session.h"
#include "format/source/source.h"
#include "lattice/progress.h"

namespace gigabake {

struct SharedSources {
  SceneSources scene;                                      ///< rank 0's; empty elsewhere
  std::shared_ptr<const std::vector<std::uint8_t>> bytes;  ///< format/job/source_bytes.h, on every rank
};

/// Collective. While rank 0 opens the source it tells the others that it lives, however long that takes.
/// Errors  CollectiveFailure: as open_sources() on rank 0, or another rank does not see the path. Stopped: as rank 0
/// was
///         asked. RankLost: nothing heard of rank 0 for as long as a collective call waits.
SharedSources open_shared_sources(MpiSession& mpi, const std::filesystem::path& path, const SourceOptions& options,
                                  const Progress& progress);

}  // namespace gigabake
