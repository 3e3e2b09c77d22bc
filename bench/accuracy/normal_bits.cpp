#include "bench/accuracy/normal_bits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/schedule_model.h"
#include "format/scene/scene_xml.h"
#include "format/shard/shard.h"
#include "lattice/octahedral.h"

namespace gigabake::bench {
namespace {

using Direction = std::array<double, 3>;
using Octahedral = std::array<double, 2>;  ///< -1 … 1

Octahedral folded(const Octahedral& p) {
  return {(1 - std::fabs(p[1])) * (p[0] < 0 ? -1 : 1), (1 - std::fabs(p[0])) * (p[1] < 0 ? -1 : 1)};
}

Octahedral to_octahedral(const Direction& n) {
  const double sum = std::fabs(n[0]) + std::fabs(n[1]) + std::fabs(n[2]);
  const Octahedral p{n[0] / sum, n[1] / sum};
  return n[2] < 0 ? folded(p) : p;
}

Direction from_octahedral(const Octahedral& p) {
  const double z = 1 - std::fabs(p[0]) - std::fabs(p[1]);
  const Octahedral q = z < 0 ? folded(p) : p;
  const double length = std::hypot(q[0], q[1], z);
  return {q[0] / length, q[1] / length, z / length};
}

Octahedral rounded(const Octahedral& p, int bits) {
  const double most = std::ldexp(1.0, bits / 2 - 1) - 1;
  return {std::round(p[0] * most) / most, std::round(p[1] * most) / most};
}

double angle_deg(const Direction& a, const Direction& b) {
  const double chord = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  return 2 * std::asin(std::min(1.0, chord / 2)) * 180 / std::numbers::pi;
}

/// Histogram of angles in thousandths of a degree.
class Angles {
 public:
  void add(double deg) {
    sum_ += deg;
    ++count_;
    ++of_[std::min(of_.size() - 1, std::size_t(deg * 1000))];
  }
  double mean() const { return count_ == 0 ? 0 : sum_ / double(count_); }
  /// Returns the angle below which 99 % of the angles are.
  double most() const {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < of_.size(); ++i)
      if (double(below += of_[i]) >= 0.99 * double(count_)) return double(i) / 1000;
    return 180;
  }

 private:
  double sum_ = 0;
  std::uint64_t count_ = 0;
  std::vector<std::uint64_t> of_ = std::vector<std::uint64_t>(180001);
};

/// Rounds the normal to `bits` bits and stores the nearest 16-bit code. Returns the angle of the change in degrees.
double coarsen(std::int8_t oct[2], int bits) {
  const std::array<float, 3> stored = unit_normal(oct);
  const Octahedral p = rounded({oct[0] / 127.0, oct[1] / 127.0}, bits);
  for (int a = 0; a < 2; ++a) oct[a] = std::int8_t(std::lround(p[std::size_t(a)] * 127));
  return angle_deg({stored[0], stored[1], stored[2]}, from_octahedral(p));
}

void coarsen(Shard& shard, int bits, Angles& angles) {
  for (std::size_t lod = 0; lod < shard.levels.size(); ++lod) {
    std::vector<std::int8_t>& normal = shard.levels[lod].normal;
    for (std::size_t i = 0; i < normal.size(); i += 2) {
      const double angle = coarsen(&normal[i], bits);
      if (lod == 0) angles.add(angle);
    }
  }
  for (std::array<std::int8_t, 2>& normal : shard.nodes.normal) coarsen(normal.data(), bits);
}

void add_sphere(NormalBits& row) {
  constexpr int directions = 200000;
  for (int i = 0; i < directions; ++i) {
    const double z = 2 * uniform(1, 2 * std::uint64_t(i)) - 1,
                 turn = 2 * std::numbers::pi * uniform(1, 2 * std::uint64_t(i) + 1), flat = std::sqrt(1 - z * z);
    const Direction n{flat * std::cos(turn), flat * std::sin(turn), z};
    const double angle = angle_deg(n, rounded_normal(n, row.bits));
    row.sphere_deg += angle / directions;
    row.largest_deg = std::max(row.largest_deg, angle);
  }
}

}  // namespace

std::array<double, 3> rounded_normal(const std::array<double, 3>& n, int bits) {
  return from_octahedral(rounded(to_octahedral(n), bits));
}

std::vector<NormalBits> normal_bits(const std::filesystem::path& scene, const std::filesystem::path& out, Codec codec,
                                    int threads) {
  const SceneDescription description = read_scene(scene);
  std::vector<NormalBits> rows;
  if (!description.has_normals) return rows;
  for (const int bits : {16, 12, 10, 8, 6}) {
    NormalBits row;
    row.bits = bits;
    add_sphere(row);
    Angles angles;
    const std::filesystem::path folder = out / ("normals-" + std::to_string(bits));
    for (const SceneCell& cell : description.cells) {
      Shard shard = read_shard(scene.parent_path() / cell.file);
      coarsen(shard, bits, angles);
      std::filesystem::create_directories((folder / cell.file).parent_path());
      row.bytes += write_shard(folder / cell.file, shard, {ThreadPool(threads), codec}).file;
    }
    write_scene(folder / "scene.xml", description);
    row.mean_deg = angles.mean();
    row.most_deg = angles.most();
    rows.push_back(row);
  }
  return rows;
}

}  // namespace gigabake::bench
