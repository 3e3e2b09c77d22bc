/// How large the texels of a source's textures are on its surface.
#pragma once

#include "format/source/mesh.h"

namespace gigabake {

/// Sums over textured triangles, so that several tiles can be added.
struct TexelSize {
  double area_m2 = 0;        ///< of textured surface
  double log_size_area = 0;  ///< ln(texel edge in metres) times area

  void add(const TexelSize& other);
  /// The mean by area of the logarithm, as a length: half of the surface, about, has finer texels. 0: no texture.
  double mean_m() const;
};

/// Of the first four million triangles, instances included. Cost  Reads the header of every image that is used.
/// Errors  InputError: a header that says no size.
TexelSize texel_size(const TileMesh& mesh);

}  // namespace gigabake
