/// The mean of an alpha-tested texture over a footprint of some texels: a renderer tests the interpolated alpha at
/// every point, so its share that passes is wanted, and the colour of that share.
///
/// Points over the footprint, each for its part of it; where the alpha of a part's plane, by its value and gradient at
/// the point, passes the cutoff only partly, so much of the part counts as the plane says.
///
/// Space   Texels of the image itself, the first one's middle at 0.
/// Exact   IEEE floats and integers: host and device agree.
/// Cost    At most 49 points, four texels each.
#pragma once

#include <cmath>
#include <cstdint>

#include "kernels/body/filter_texture.h"
#include "kernels/body/sample_texture.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

/// Parts along an edge of so many texels, each less than two thirds of a texel.
GB_HD int parts_across(float texels) { return smaller(int(texels * 1.5f) + 1, 7); }

/// A footprint as a parallelogram with its moments: columns of points, each shifted along t by `lean` of its own
/// offset.
struct TestedGrid {
  int columns, rows;
  float width, height, lean;  ///< of one part
};

GB_HD TestedGrid tested_grid(const LevelFootprint& f) {
  const float lean = 12 * f.covariance / (f.width * f.width),
              left = f.height * f.height - lean * lean * f.width * f.width;
  const float height = left > 0 ? std::sqrt(left) : 0;
  TestedGrid r{parts_across(f.width), parts_across(f.height), 0, 0, lean};
  r.width = f.width / float(r.columns);
  r.height = height / float(r.rows);
  return r;
}

/// 2^-32 texels.
GB_HD std::int64_t fine_texels(float texels) { return std::int64_t(std::int32_t(texels * float(1 << 24))) * 256; }

/// Four texels around a point.
struct TexelSquare {
  Rgba16 texel[4];
  float x, y;  ///< from the first one
};

GB_HD TexelSquare square_at(const TextureView& view, const MaterialView& m, const LevelPlace& p, std::int64_t x,
                            std::int64_t y, const Tables& tables) {
  TexelSquare r;
  r.x = float(std::int32_t(std::uint32_t(x) >> 8)) * (1.0f / (1 << 24));
  r.y = float(std::int32_t(std::uint32_t(y) >> 8)) * (1.0f / (1 << 24));
  GB_UNROLL
  for (int k = 0; k < 4; ++k) {
    const std::int32_t column = texel_near(std::int32_t(x >> 32) + (k & 1), p.width, m.wrap_s),
                       row = texel_near(std::int32_t(y >> 32) + (k >> 1), p.height, m.wrap_t);
    r.texel[k] = linear_texel<false>(view, 0, std::size_t(row) * std::size_t(p.width) + std::size_t(column), tables);
  }
  return r;
}

GB_HD float bilinear(const TexelSquare& q, int c) {
  const float upper = float(q.texel[0].c[c]) + q.x * float(int(q.texel[1].c[c]) - int(q.texel[0].c[c])),
              lower = float(q.texel[2].c[c]) + q.x * float(int(q.texel[3].c[c]) - int(q.texel[2].c[c]));
  return upper + q.y * (lower - upper);
}

/// Of a part (g.width x g.height) the share whose alpha passes, of 256.
GB_HD std::uint32_t passing_share(const TexelSquare& q, const TestedGrid& g, float alpha, std::uint8_t cutoff) {
  const float a = q.texel[0].c[3], b = q.texel[1].c[3], d = q.texel[2].c[3], e = q.texel[3].c[3];
  const float along_x = (b - a) + q.y * ((e - d) - (b - a)), along_y = (d - a) + q.x * ((e - b) - (d - a));
  const float x = std::fabs(along_x + along_y * g.lean) * g.width, y = std::fabs(along_y) * g.height;
  const float reach = larger(x, y), beyond = alpha - float(cutoff * 257u);
  const float share = 0.5f + (reach > 1 ? beyond / reach : beyond);
  return std::uint32_t(256 * (share < 0 ? 0 : (share > 1 ? 1.0f : share)) + 0.5f);
}

/// Premultiplied linear mean of what passes.
GB_HD_ONE_COPY Rgba16 tested_sample(const TextureView& view, const MaterialView& m, const LevelPlace& place,
                                    const LevelFootprint& footprint, const Tables& tables) {
  const TestedGrid grid = tested_grid(footprint);
  const int points = grid.columns * grid.rows;
  std::uint32_t sum[4] = {0, 0, 0, 0};
  GB_NO_UNROLL
  for (int i = 0; i < points; ++i) {
    const float x = (float(i % grid.columns) - 0.5f * float(grid.columns - 1)) * grid.width,
                y = (float(i / grid.columns) - 0.5f * float(grid.rows - 1)) * grid.height + x * grid.lean;
    const TexelSquare square = square_at(view, m, place, place.x + fine_texels(x), place.y + fine_texels(y), tables);
    const float alpha = bilinear(square, 3);
    const std::uint32_t share = alpha > 0 ? passing_share(square, grid, alpha, view.mask_cutoff) : 0;
    if (share == 0) continue;
    for (int c = 0; c < 3; ++c)
      sum[c] += share * std::uint32_t(smaller(bilinear(square, c) / alpha, 1.0f) * 65535 + 0.5f);
    sum[3] += share * 65535;
  }
  Rgba16 r;
  const std::uint32_t half = 128 * std::uint32_t(points);
  for (int c = 0; c < 4; ++c) r.c[c] = std::uint16_t((sum[c] + half) / (256 * std::uint32_t(points)));
  return r;
}

}  // namespace gigabake::kernels
