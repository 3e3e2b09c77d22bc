/// The ranks of a launch as a team that writes one export.
#pragma once

#include "cluster/mpi/mpi_session.h"
#include "format/export/voxel_tiles/voxel_tileset.h"

namespace gigabake {

/// A team over MPI. A step may take up to a day, because the other ranks wait that long. If a rank dies, mpirun ends
/// the other ranks.
/// Errors  together() throws Stopped if a rank was stopped, CollectiveFailure if a step failed. together(),
///         exchange() and collect() throw RankLost if a rank does not answer within a day.
class MpiExportTeam : public ExportTeam {
 public:
  explicit MpiExportTeam(MpiSession& mpi);

  int rank() const override { return mpi_.rank(); }
  int ranks() const override { return mpi_.ranks(); }
  void together(const std::function<void()>& step) const override;
  std::vector<std::vector<std::uint8_t>> exchange(std::vector<std::uint8_t> own) const override;
  std::vector<std::vector<std::uint8_t>> collect(std::vector<std::uint8_t> own) const override;

 private:
  MpiSession& mpi_;
};

}  // namespace gigabake
