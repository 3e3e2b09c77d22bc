/// What a bake would come to, measured: pieces of the scene are baked into a folder that goes again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cluster/bake.h"
#include "cluster/bake_scratch.h"
#include "cluster/plan_textures.h"
#include "lattice/progress.h"
#include "scheduler/size_estimate.h"

namespace gigabake {

struct MeasuredSize {
  double voxel_size_m = 0;
  SizeEstimate estimate;
  std::size_t pieces = 0, tiles = 0;  ///< that were baked, and of how many tiles
  double wall_s = 0;                  ///< of that
  bool on_device = false;
  std::string problem;  ///< one line; not empty: why there are fewer pieces than there could be
};

struct PlanMeasure {
  std::vector<MeasuredSize> sizes;       ///< half the voxel size that was asked for, it, and twice it
  int ranks = 1, threads = 1;            ///< of the bake; pieces were baked by one rank
  ScratchNeed scratch;                   ///< of the bake's large tiles
  std::filesystem::path scratch_folder;  ///< where the bake keeps them; "OUT/scratch" where OUT is not known
  TextureFindings textures;
};

/// Of a plan by plan_bake() on rank 0; the other ranks need not call it.
/// measures: bake pieces; else voxels and bytes are those of the surface's area alone, and there are no times.
/// Cost    About four seconds, and at most some twenty: then what was baked so far counts. A driver's start, and the
///         first cut of a tile that is large beside the memory, come on top. Shards of at most a few pieces, and large
///         tiles in clusters, lie in request.scratch, or in the system's folder for temporary files.
/// Errors  None of the sources': a size says what was wrong, also that the disk has no room for large tiles.
///         InputError: no temporary folder can be made. Stopped.
PlanMeasure measure_plan(const MpiSession& mpi, const BakeRequest& request, const SharedSources& sources,
                         const BakePlan& plan, bool measures, const Progress& progress = {});

}  // namespace gigabake
