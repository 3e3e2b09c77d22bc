/// The ranks of a launch as a team that writes one export.
#pragma once

#include "cluster/mpi/mpi_session.h"
#include "format/export/voxel_tiles/voxel_tileset.h"

namespace gigabake {

/// Team over MPI. Steps have no time limit: a rank waits up to a day for the others, and mpirun ends it if one of them
/// dies.
/// Errors  Both collective members throw Stopped if a rank was stopped, CollectiveFailure if a step failed.
class MpiExportTeam : public ExportTeam {
 public:
  explicit MpiExportTeam(MpiSession& mpi);

  int rank() const override { return mpi_.rank(); }
  int ranks() const override { return mpi_.ranks(); }
  void together(const std::function<void()>& step) const override;
  std::vector<std::vector<std::uint8_t>> exchange(std::vector<std::uint8_t> own) const override;

 private:
  MpiSession& mpi_;
};

}  // namespace gigabake
