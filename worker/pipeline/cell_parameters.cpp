#include "worker/pipeline/cell_parameters.h"

#include <bit>

#include "worker/pipeline/lattice.h"

namespace gigabake {

kernels::CellParameters cell_parameters(const CellJob& job, const BakeParameters& p, std::uint64_t kernel_bytes) {
  kernels::CellParameters c;
  c.frame = snap_frame(p);
  c.window_min = job.lattice_min;
  c.window_voxels = job.cell_voxels;
  c.surface = p.surface;
  c.mip = p.mip;
  c.normals = p.normals;
  c.directional_coverage = has_directional_coverage(p);
  c.classes = p.classes;
  c.max_error = p.max_error;
  c.depth_error = p.depth_error;
  c.memory_bytes = kernel_bytes;
  return c;
}

kernels::OverviewParameters overview_parameters(const CellJob& job, const BakeParameters& p) {
  kernels::OverviewParameters out;
  out.window_min = job.lattice_min;
  out.child_lod = int(job.first_lod + job.copied_lods) - 1;
  out.levels = std::countr_zero(job.cell_voxels / brick_edge) - out.child_lod;
  out.mip = p.mip;
  out.normals = p.normals;
  out.directional_coverage = has_directional_coverage(p);
  out.classes = p.classes;
  out.max_error = p.max_error;
  return out;
}

}  // namespace gigabake
