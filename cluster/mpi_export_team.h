/// The ranks of a launch as a team that writes one export.
#pragma once

#include "cluster/mpi_session.h"
#include "format/export/export_team.h"

namespace gigabake {

/// Steps may take as long as they do: a rank waits a day for the others, and is ended with mpirun where one of them
/// dies. Errors  of both collective members: Stopped where a rank was stopped; CollectiveFailure where a step failed.
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
