/// Mean size of texels on a source's surface.
#pragma once

#include "format/source/mesh.h"

namespace gigabake {

/// Sums over textured triangles; sums of several tiles can be added.
struct TexelSize {
  double area_m2 = 0;        ///< of textured surface
  double log_size_area = 0;  ///< ln(texel edge in metres) times area

  void add(const TexelSize& other);
  /// Returns the area-weighted geometric mean of the texel edge: about half of the surface has finer texels. 0: no
  /// texture.
  double mean_m() const;
};

/// Returns the sums of the first four million triangles, instances included.
/// Cost    Reads the header of every image that is used.
/// Errors  InputError: an image header without a size.
TexelSize texel_size(const TileMesh& mesh);

}  // namespace gigabake
