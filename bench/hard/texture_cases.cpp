#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/hard/hard_case.h"
#include "core/base/error.h"

namespace gigabake::bench {
namespace {

constexpr int sheet_voxels = 16;
constexpr std::int64_t sheet_units = 256 * sheet_voxels;

reference::ExpectedVoxel plain(double alpha, const Vec3d& linear) {
  reference::ExpectedVoxel v;
  v.area = 1;
  v.visible = alpha;
  v.colour = linear * alpha;
  v.normal = {0, 0, alpha};
  return v;
}

/// A linear map from voxels to texture coordinates.
struct SheetMap {
  double u0, v0, step;  ///< step: per voxel
};

HardCase image_case(const std::string& name, const std::string& what, Image image, AlphaMode mode) {
  HardCase hard = lattice_case(name, "textures", what);
  hard.window = {{0, 0, 0}, sheet_voxels};
  HardTile& tile = hard.scenes[0].tiles[0];
  tile.images = {std::move(image)};
  tile.materials[0].image = 0;
  tile.materials[0].mode = mode;
  hard.bounds.colour_codes = {};
  return hard;
}

/// Adds a square of 16 × 16 voxels in the middle of a layer of voxels.
void add_sheet(HardCase& hard, std::int64_t layer, const SheetMap& map) {
  const std::int64_t e = sheet_units, z = 256 * layer + 128;
  HardTile& tile = hard.scenes[0].tiles[0];
  add_mesh(tile, {{{{0, 0, z}, {e, 0, z}, {e, e, z}}}, {{{0, 0, z}, {e, e, z}, {0, e, z}}}}, lattice_unit_m);
  HardMesh& mesh = tile.meshes.back();
  for (std::size_t v = 0; v < mesh.position.size(); v += 3) {
    mesh.uv.push_back(float(map.u0 + map.step * mesh.position[v] / 256));
    mesh.uv.push_back(float(map.v0 + map.step * mesh.position[v + 1] / 256));
  }
}

/// Returns a case with a texture atlas of a red and a blue chart. The square shows the red chart up to the seam, and
/// coarser texels mix both colours across the seam. Bilinear magnification without prefiltering shows blue in the last
/// half texel; prefiltering must add only little blue.
HardCase seam(const std::string& texels_text, double texels, double bound, double reach_voxels) {
  constexpr int size = 512, border = 301;
  Image atlas{size, size, {}, false};
  for (int i = 0; i < size * size; ++i) {
    const bool is_red = i % size < border;
    atlas.rgba.insert(atlas.rgba.end(), {std::uint8_t(is_red ? 255 : 0), 0, std::uint8_t(is_red ? 0 : 255), 255});
  }
  HardCase hard = image_case("atlas-seam-" + texels_text,
                             texels_text + " texels a voxel up to the next chart; integral of the bilinear texture",
                             std::move(atlas), AlphaMode::opaque);
  const double step = texels / size;
  add_sheet(hard, 0, {double(border) / size - sheet_voxels * step, 0.2, step});
  hard.bounds.colour_linear = bound;
  // The fraction of blue at d texels from the seam is ½ - d, up to half a texel.
  const auto integral = [](double d) { return std::min(d, 0.5) * (1 - std::min(d, 0.5)) / 2; };
  hard.expected = [=] {
    ExpectedVoxels out;
    for (std::int64_t y = 0; y < sheet_voxels; ++y)
      for (std::int64_t x = 0; x < sheet_voxels; ++x) {
        const double near = texels * double(sheet_voxels - 1 - x);
        const double blue = (integral(near + texels) - integral(near)) / texels;
        out[{x, y, 0}] = plain(1, {1 - blue, 0, blue});
      }
    return out;
  };
  hard.more = [=](const HardBake& bake) {
    double beyond = 0;
    for (const auto& [voxel, stored] : bake.voxels)
      if (double(sheet_voxels - 1 - voxel[0]) >= reach_voxels)
        beyond = std::max(beyond, reference::linear_of(stored.rgba[2] / 255.0));
    return std::vector<HardFigure>{
        {"bleeds farther than " + std::to_string(int(reach_voxels)) + " voxels", "", beyond, 0}};
  };
  return hard;
}

/// Returns the length of the intersection of [low, low + size) and [at, at + 1).
double overlap(double low, double size, std::int64_t at) {
  return std::max(0.0, std::min(low + size, double(at + 1)) - std::max(low, double(at)));
}

/// The bounds of a masked texel. A fragment samples the mask around its centroid, not over its area. The area of one
/// texel is therefore right only in the mean over positions. At a single position the area may be lost or several times
/// too large.
struct MaskBounds {
  double alpha_codes, mean_area, max_area, lost;
};

/// Returns a case with an alpha-tested texture in which one of 65,536 texels is opaque. Each of 16 squares shows this
/// texel at a different position in a voxel.
HardCase single_texel(const std::string& texels_text, double texels, double area, const MaskBounds& bounds) {
  constexpr int size = 256, at = 128;
  Image image{size, size, std::vector<std::uint8_t>(std::size_t(4) * size * size), true};
  std::fill_n(image.rgba.begin() + 4 * (at * size + at), 4, std::uint8_t(255));
  HardCase hard = image_case("single-texel-" + texels_text,
                             "one opaque texel of 65,536, " + texels_text + " texels a voxel, in 16 places; its area",
                             std::move(image), AlphaMode::mask);
  const double edge = std::sqrt(area) / texels;  // edge of the texel, in voxels
  const auto start = [=](std::int64_t quarter) { return 7 + double(quarter) / 4 + (1 / texels - edge) / 2; };
  for (int k = 0; k < sheet_voxels; ++k) {
    const auto from = [&](int quarter) { return (at - (7 + quarter / 4.0) * texels) / size; };
    add_sheet(hard, k, {from(k % 4), from(k / 4), texels / size});
  }
  hard.bounds.alpha_codes = bounds.alpha_codes;
  hard.expected = [=] {
    ExpectedVoxels out;
    for (std::int64_t k = 0; k < sheet_voxels; ++k)
      for (std::int64_t y = 0; y < sheet_voxels; ++y)
        for (std::int64_t x = 0; x < sheet_voxels; ++x)
          if (const double share = overlap(start(k % 4), edge, x) * overlap(start(k / 4), edge, y); share > 0)
            out[{x, y, k}] = plain(share, {1, 1, 1});
    return out;
  };
  hard.more = [=](const HardBake& bake) {
    std::array<double, sheet_voxels> found{};
    for (const auto& [voxel, stored] : bake.voxels)
      found[std::size_t(voxel[2])] += stored.rgba[3] / 255.0 * texels * texels;
    double sum = 0, maximum = 0, lost = 0;
    for (const double a : found) sum += a, maximum = std::max(maximum, a), lost += a == 0;
    return std::vector<HardFigure>{{"lost", "of 16", lost, bounds.lost},
                                   {"mean area", "texels off " + std::to_string(area).substr(0, 4),
                                    std::abs(sum / sheet_voxels - area), bounds.mean_area},
                                   {"largest area", "texels", maximum, bounds.max_area}};
  };
  return hard;
}

/// Returns a case with texture coordinates that are not finite or are too large. Such coordinates count as 0, so they
/// show the first texel of a 2 × 2 texture.
HardCase no_numbers() {
  Image image{2, 2, {}, false};
  image.rgba = {255, 0, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255, 0, 255};
  HardCase hard = image_case("uv-not-a-number", "NaN, ±Inf and 10^30 as texture coordinates; the colour at (0, 0)",
                             std::move(image), AlphaMode::opaque);
  HardTile& tile = hard.scenes[0].tiles[0];
  const float inf = std::numeric_limits<float>::infinity();
  std::int64_t x = 0;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), inf, -inf, 1e30f, 0.0f}) {
    const std::int64_t z = 100;
    add_mesh(tile, {{{{x + 10, 10, z}, {x + 110, 20, z}, {x + 30, 100, z}}}}, lattice_unit_m);
    tile.meshes.back().uv = {0, 0, bad, 0, 0, 0};
    x += 256;
  }
  hard.bounds.colour_codes = 0.65;
  hard.expected = [] {
    ExpectedVoxels out;
    for (std::int64_t i = 0; i < 5; ++i) out[{i, 0, 0}] = plain(1, {1, 0, 0});
    return out;
  };
  hard.more = [](const HardBake& bake) {
    return std::vector<HardFigure>{{"not counted", "triangles", std::abs(double(bake.report.bad_uv) - 4), 0}};
  };
  return hard;
}

}  // namespace

std::vector<HardCase> texture_cases() {
  const double bilinear = 2 - 2 * std::log(2.0);  // texels in which the bilinear alpha is at least ½
  return {no_numbers(),
          seam("1/4", 0.25, 0.01, 4),
          seam("1", 1, 0.01, 2),
          seam("3", 3, 0.01, 2),
          seam("5.3", 5.3, 0.02, 2),
          seam("16", 16, 0.04, 2),
          single_texel("1/4", 0.25, bilinear, {110, 0.02, 1, 0}),
          single_texel("1", 1, bilinear, {65, 0.07, 1, 0}),
          single_texel("4", 4, 1, {30, 0.05, 3, 0}),
          single_texel("16", 16, 1, {3, 0.25, 4, 5})};
}

}  // namespace gigabake::bench
