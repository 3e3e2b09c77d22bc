#include "format/source/tiles/i3dm_instances.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/math/georeference.h"
#include "format/source/mesh.h"

namespace gigabake {
namespace {

using Vector = std::array<double, 3>;
using TileTransform = Affine<World, World>;

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Returns the unit vector of octahedral coordinates, which are stored with 16 bits each.
/// Source  Meyer, Süßmuth, Sußner, Stamminger, Greiner 2010; 3D Tiles 1.0, "Oct-encoded normal vectors".
Vector oct_decoded(std::uint16_t u, std::uint16_t v) {
  double x = u / 65535.0 * 2 - 1, y = v / 65535.0 * 2 - 1;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  if (z < 0) {
    const double folded = x;
    x = (1 - std::fabs(y)) * (folded >= 0 ? 1 : -1);
    y = (1 - std::fabs(folded)) * (y >= 0 ? 1 : -1);
  }
  const double length = std::sqrt(x * x + y * y + z * z);
  return {x / length, y / length, z / length};
}

/// Returns the rows of the inverse of the linear part, by Cramer's rule; nullopt if there is no inverse.
std::optional<std::array<Vector, 3>> inverse_rows(const TileTransform& m) {
  const auto column = [&](std::size_t c) { return Vector{m.m[0][c], m.m[1][c], m.m[2][c]}; };
  const Vector a = column(0), b = column(1), c = column(2), bc = cross(b, c);
  const double determinant = dot(a, bc);
  if (!std::isnormal(determinant)) return std::nullopt;
  std::array<Vector, 3> rows{bc, cross(c, a), cross(a, b)};
  for (Vector& row : rows)
    for (double& v : row) v /= determinant;
  return rows;
}

class Instances {
 public:
  Instances(const std::filesystem::path& file, const FeatureTable& table, const TileTransform& world_from_tile,
            const Vector& rtc_center)
      : file_(file), table_(table), world_from_tile_(world_from_tile), rtc_(rtc_center) {
    const auto count = table.count("INSTANCES_LENGTH");
    if (!count) fail("INSTANCES_LENGTH", "is missing");
    if (*count > max_placements) fail("INSTANCES_LENGTH", "more than 2^24 instances; split the tile");
    MemoryClaim(file).add_items(*count, placement_bytes, "feature table.INSTANCES_LENGTH", "instances");
    count_ = *count;
    read_positions();
    up_ = read_normals("NORMAL_UP", "NORMAL_UP_OCT32P");
    right_ = read_normals("NORMAL_RIGHT", "NORMAL_RIGHT_OCT32P");
    if (up_.empty() != right_.empty()) fail("NORMAL_UP", "expected NORMAL_UP and NORMAL_RIGHT together");
    scale_ = table.floats("SCALE", count_, 1);
    scales_ = table.floats("SCALE_NON_UNIFORM", count_, 3);
    if (up_.empty() && table.flag("EAST_NORTH_UP")) tile_from_world_ = inverse_rows(world_from_tile);
  }

  std::vector<TileTransform> maps() const {
    std::vector<TileTransform> out;
    out.reserve(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      out.push_back(map(i));
      if (!out.back().is_finite())
        fail("POSITION", "the transform of instance " + std::to_string(i) + " is not finite");
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const char* key, const std::string& message) const {
    throw InputError(file_, std::string("feature table.") + key, message);
  }

  void read_positions() {
    for (const float v : table_.floats("POSITION", count_, 3)) position_.push_back(v);
    if (!position_.empty() || count_ == 0) return;
    const std::vector<std::uint16_t> quantized = table_.shorts("POSITION_QUANTIZED", count_, 3);
    if (quantized.empty()) fail("POSITION", "is missing, and so is POSITION_QUANTIZED");
    const auto offset = table_.vector("QUANTIZED_VOLUME_OFFSET"), scale = table_.vector("QUANTIZED_VOLUME_SCALE");
    if (!offset || !scale) fail("POSITION_QUANTIZED", "expected QUANTIZED_VOLUME_OFFSET and QUANTIZED_VOLUME_SCALE");
    for (std::size_t i = 0; i < quantized.size(); ++i)
      position_.push_back(quantized[i] / 65535.0 * (*scale)[i % 3] + (*offset)[i % 3]);
  }

  std::vector<Vector> read_normals(const char* plain, const char* packed) const {
    std::vector<Vector> out;
    const std::vector<float> floats = table_.floats(plain, count_, 3);
    for (std::size_t i = 0; i + 2 < floats.size(); i += 3) out.push_back({floats[i], floats[i + 1], floats[i + 2]});
    if (!out.empty()) return out;
    const std::vector<std::uint16_t> octs = table_.shorts(packed, count_, 2);
    for (std::size_t i = 0; i + 1 < octs.size(); i += 2) out.push_back(oct_decoded(octs[i], octs[i + 1]));
    return out;
  }

  /// Returns the x, y and z axes of the model in the tile's frame. `p` is the position of instance `i`.
  std::array<Vector, 3> axes(std::size_t i, const Vector& p) const {
    if (!up_.empty()) return {right_[i], up_[i], cross(right_[i], up_[i])};
    const std::array<Vector, 3> own{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (!tile_from_world_) return own;
    const Point<World> at = world_from_tile_({rtc_[0] + p[0], rtc_[1] + p[1], rtc_[2] + p[2]});
    const Point<Ecef> p_ecef_m{at.x, at.y, at.z};
    if (!is_on_earth(p_ecef_m)) return own;
    const Affine<Ecef, Scene> enu = ecef_from_enu(geodetic_of(p_ecef_m));
    std::array<Vector, 3> out;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row)
        out[axis][row] = dot((*tile_from_world_)[row], {enu.m[0][axis], enu.m[1][axis], enu.m[2][axis]});
      const double length = std::sqrt(dot(out[axis], out[axis]));  // the caller applies the tile's scale
      for (double& v : out[axis]) v /= length;
    }
    return out;
  }

  TileTransform map(std::size_t i) const {
    const Vector p{position_[3 * i], position_[3 * i + 1], position_[3 * i + 2]};
    const std::array<Vector, 3> column = axes(i, p);
    TileTransform out;
    for (std::size_t c = 0; c < 3; ++c) {
      const double scale = (scale_.empty() ? 1.0 : scale_[i]) * (scales_.empty() ? 1.0 : scales_[3 * i + c]);
      for (std::size_t row = 0; row < 3; ++row) out.m[row][c] = column[c][row] * scale;
      out.m[c][3] = p[c];
    }
    return out;
  }

  const std::filesystem::path& file_;
  const FeatureTable& table_;
  const TileTransform& world_from_tile_;
  Vector rtc_;
  std::size_t count_ = 0;
  std::vector<double> position_;
  std::vector<Vector> up_, right_;
  std::vector<float> scale_, scales_;
  std::optional<std::array<Vector, 3>> tile_from_world_;
};

}  // namespace

std::vector<Affine<World, World>> i3dm_instances(const std::filesystem::path& file, const FeatureTable& table,
                                                 const Affine<World, World>& world_from_tile,
                                                 const std::array<double, 3>& rtc_center) {
  return Instances(file, table, world_from_tile, rtc_center).maps();
}

}  // namespace gigabake
