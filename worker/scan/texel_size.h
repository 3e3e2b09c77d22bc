/// Mean size of texels on a source's surface.
#pragma once

#include "format/source/mesh.h"

namespace gigabake {

/// Sums over textured triangles; sums of several tiles can be added.
struct TexelSize {
  double area_m2 = 0;        ///< area of the textured surface
  double log_size_area = 0;  ///< sum of ln(texel edge in metres) · area in m²

  void add(const TexelSize& other);
  /// Returns the area-weighted geometric mean of the texel edge; 0 if there is no texture. About half of the surface
  /// has finer texels.
  double mean_m() const;
};

/// Returns the sums over the first 2^22 triangles; every instance of a triangle counts.
/// Cost    Reads the header of every image that is used.
/// Errors  InputError if an image header does not state a size.
TexelSize texel_size(const TileMesh& mesh);

}  // namespace gigabake
