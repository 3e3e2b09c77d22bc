/// A measured estimate of a bake, from sample pieces of the scene that are baked into a temporary folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cluster/bake/bake.h"
#include "cluster/bake/bake_scratch.h"
#include "cluster/bake/plan_textures.h"
#include "core/base/progress.h"
#include "scheduler/plan/size_estimate.h"

namespace gigabake {

struct MeasuredSize {
  double voxel_size_m = 0;
  SizeEstimate estimate;
  std::size_t pieces = 0, tiles = 0;  ///< number of sample pieces baked, and of tiles that they come from
  std::uint64_t voxels_found = 0;     ///< voxels of lod 0 in the pieces
  double wall_s = 0;                  ///< wall time of the pieces
  bool on_device = false;
  std::string problem;  ///< the reason why fewer pieces were baked than planned, one line; else empty
};

struct PlanMeasure {
  std::vector<MeasuredSize> sizes;  ///< half the requested voxel size, the requested size, and twice that size
  int ranks = 1, threads = 1;       ///< of the bake; pieces are baked by one rank
  ScratchNeed scratch;              ///< of the bake's large tiles
  /// The bake's scratch folder; "SCENE/scratch" if the request names neither OUT nor a scratch folder.
  std::filesystem::path scratch_folder;
  TextureFindings textures;

  const MeasuredSize& requested() const { return sizes.at(1); }
};

/// Measures a plan from plan_bake(). Only rank 0 needs to call it. If `measures`, bakes sample pieces. Otherwise
/// estimates voxels and bytes from the surface area only, without times.
/// Cost    Takes about 4 s, and at most about 20 s; pieces that are not baked by then are not used. The driver's start
///         and the first split of a large tile take additional time. The shards of a few pieces and the clusters of
///         large tiles are stored in request.scratch or in the system's temporary folder.
/// Errors  InputError: no temporary folder can be made. Stopped. An error of the sources, or a disk that is too
///         small for large tiles, is reported in MeasuredSize::problem.
PlanMeasure measure_plan(const MpiSession& mpi, const BakeRequest& request, const SharedSources& sources,
                         const BakePlan& plan, bool measures, const Progress& progress = {});

}  // namespace gigabake
