/// A whole bake on all ranks: survey, plan, dispatch, merge, publish.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include "cluster/mpi_session.h"
#include "format/parameters.h"
#include "format/scene_xml.h"
#include "format/source.h"
#include "scheduler/plan.h"

namespace gigabake {

struct BakeRequest {
  std::filesystem::path source, out;
  SourceOptions source_options;
  BakeParameters parameters;
  int threads = 0;                 ///< of each rank; 0: the host's cores shared by its ranks
  std::uint64_t memory_bytes = 0;  ///< of each rank; 0: no bound
  bool keep_going = true;          ///< after a cell failed
};

/// Thrown on the ranks where nothing was wrong when another rank failed: that one has the message.
class OtherRankFailed : public std::exception {
 public:
  const char* what() const noexcept override { return "another rank failed"; }
};

/// Told to rank 0 alone, in the order in which it happens.
struct BakeProgress {
  std::function<void(const SceneSources&)> opened;
  std::function<void(const BakePlan&)> planned;
  std::function<void(const CellReport&, const CellJob&, std::size_t done, std::size_t all)> cell_done;
};

/// Sums over cells; wall seconds of stages overlap.
struct BakeSummary {
  SceneDescription scene;
  double survey_s = 0, bake_s = 0, read_s = 0, kernel_s = 0, write_s = 0;
  std::uint64_t peak_kernel_bytes = 0;
  std::size_t cells_planned = 0, cells_empty = 0;
  int ranks = 1, threads = 1;
};

/// Collective. The scene and the sums are rank 0's; other ranks get them empty.
/// OUT/scene.xml is replaced last, then shards that it does not name are removed.
/// Errors  InputError for a source that cannot be opened or has no triangles, or an OUT that cannot be written; on the
///         other ranks OtherRankFailed.
BakeSummary bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress);

/// Collective: survey and plan alone.
BakePlan plan_bake(MpiSession& mpi, const BakeRequest& request, const BakeProgress& progress);

}  // namespace gigabake
