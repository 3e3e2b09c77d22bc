/// The parameters of a bake. The parameters and the sources determine its result. scene.xml and fingerprints contain
/// the parameters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/rules.h"
#include "core/math/frames.h"
#include "core/math/vec3.h"

namespace gigabake {

struct BakeParameters {
  double voxel_size_m = 0;           ///< > 0
  Vec3d lattice_origin_m{};          ///< scene position of the lowest corner of voxel 0,0,0
  std::uint32_t cell_voxels = 1024;  ///< edge of a cell: a power of two, 8 … 8192
  SurfaceRule surface = SurfaceRule::area;
  MipFilter mip = MipFilter::coverage;
  bool normals = true;
  bool directional_coverage =
      true;  ///< store directional coverage; only for MipFilter::coverage, see has_directional_coverage()
  std::uint32_t max_error = 0;  ///< max deviation of a stored voxel in codes of 255, 0 … 127 (docs/accuracy.md)
  Codec codec = Codec::deflate;
  /// Max error of a voxel that ends a branch, 0 … 127 (docs/voxels.md). 0: only equal voxels end one.
  std::uint32_t depth_error = 0;
  /// Coarsest level with leaves; follows from the sources (format/source/levels/source_levels.h) and `depth_error`.
  std::uint32_t coarsest_lod = 0;
  /// Voxels have classes; follows from the sources and edits (format/source/classes/source_classes.h).
  bool classes = false;
};

/// Returns true if the shards of a bake with these parameters have the channel `directional_coverage`.
bool has_directional_coverage(const BakeParameters& parameters);
/// Returns one line of JSON with fixed key order and shortest round-trip numbers: equal parameters give equal text.
std::string to_json(const BakeParameters& parameters);
/// Parses the text of to_json().
/// Errors  InputError if `json` is invalid; UsageError like check().
BakeParameters parameters_from_json(const std::string& json);
/// Checks the ranges of all fields.
/// Errors  UsageError with the field whose value is out of range.
void check(const BakeParameters& parameters);

}  // namespace gigabake
