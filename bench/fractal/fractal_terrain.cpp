// Writes the benchmark terrain: a fractal height field of 2·quads² triangles with vertex colours, or with a texture, on
// one unit square.
// At --voxel-size 1/2048 it has about three surface voxels per column, as many as the terrain on which the other
// programs of docs/experiments/kernels.md were measured.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/core.h>
#include <limits>
#include <span>
#include <vector>

#include "format/sample/glb_writer.h"
#include "format/sample/noise.h"
#include "format/sample/picture.h"
#include "format/system/output_file.h"
#include "format/system/publish.h"
#include "lattice/error.h"

using namespace gigabake;

namespace {

struct Options {
  std::string out;
  int quads = 1024, texture = 0;
  std::uint32_t seed = 1;
  double roughness = 0.128, persistence = 0.55;
};

/// Midpoint displacement (diamond-square). Source  Fournier, Fussell & Carpenter 1982.
class HeightField {
 public:
  HeightField(const Options& o)
      : points_(o.quads + 1), seed_(o.seed), height_(std::size_t(points_) * std::size_t(points_), 0.0) {
    double reach = o.roughness;
    for (int step = o.quads; step > 1; step /= 2, reach *= o.persistence) {
      const int half = step / 2;
      for (int y = half; y < points_; y += step)
        for (int x = half; x < points_; x += step) displace(x, y, half, reach, true);
      for (int y = 0; y < points_; y += half)
        for (int x = (y / half) % 2 == 0 ? half : 0; x < points_; x += step) displace(x, y, half, reach, false);
    }
  }
  double at(int x, int y) const { return height_[std::size_t(y) * std::size_t(points_) + std::size_t(x)]; }
  int points() const { return points_; }

 private:
  /// The mean of the four neighbours at distance `half`, along the diagonals or the axes, plus a bell-shaped offset.
  void displace(int x, int y, int half, double reach, bool diagonal) {
    constexpr int straight[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}},
                  slanted[4][2] = {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
    double sum = 0;
    int count = 0;
    for (const auto& d : diagonal ? slanted : straight) {
      const int nx = x + d[0] * half, ny = y + d[1] * half;
      if (nx < 0 || ny < 0 || nx >= points_ || ny >= points_) continue;
      sum += at(nx, ny);
      ++count;
    }
    double bell = -6;  // twelve uniforms: variance 1
    for (int k = 0; k < 12; ++k) bell += sample::unit(sample::hash_of(seed_ + std::uint32_t(k), x, y));
    height_[std::size_t(y) * std::size_t(points_) + std::size_t(x)] = sum / count + reach * bell;
  }

  int points_;
  std::uint32_t seed_;
  std::vector<double> height_;
};

/// Of height h at (x, y), in quads; 0…1.
std::array<double, 3> colour_of(double h, double x, double y) {
  return {sample::clamp01(0.35 + 0.6 * sample::noise(7, x / 40, y / 40)), sample::clamp01(0.45 + 0.9 * h), 90 / 255.0};
}

double height_between(const HeightField& field, double x, double y) {
  const int left = int(x), top = int(y);
  return sample::lerp(sample::lerp(field.at(left, top), field.at(left + 1, top), x - left),
                      sample::lerp(field.at(left, top + 1), field.at(left + 1, top + 1), x - left), y - top);
}

/// The same colours, with a grain of two texels.
sample::Picture picture_of(const HeightField& field, int texels) {
  sample::Picture picture(texels, texels, 3);
  const double quads_per_texel = double(field.points() - 1) / texels;
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) {
      const double u = (x + 0.5) * quads_per_texel, v = (y + 0.5) * quads_per_texel;
      const std::array<double, 3> rgb = colour_of(height_between(field, u, v), u, v);
      const double grain = 0.9 + 0.2 * sample::unit(sample::hash_of(11, x / 2, y / 2));
      for (int c = 0; c < 3; ++c)
        picture.at(x, y)[c] = std::uint8_t(255 * sample::clamp01(rgb[std::size_t(c)] * grain));
    }
  return picture;
}

/// One row of values after the other: the height field is all that is held.
class MeshOfField {
 public:
  explicit MeshOfField(const HeightField& field) : field_(field), points_(field.points()), quads_(points_ - 1) {}

  sample::GlbListedMesh listed(bool textured) const {
    sample::GlbListedMesh out;
    out.vertices = std::size_t(points_) * std::size_t(points_);
    out.corners = 6 * std::size_t(quads_) * std::size_t(quads_);
    out.low = {0, std::numeric_limits<float>::max(), -1};
    out.high = {1, std::numeric_limits<float>::lowest(), -0.0f};
    for (int y = 0; y < points_; ++y)
      for (int x = 0; x < points_; ++x) {
        out.low[1] = std::min(out.low[1], float(field_.at(x, y)));
        out.high[1] = std::max(out.high[1], float(field_.at(x, y)));
      }
    const auto rows = [this](auto row, int count) {
      return [this, row, count](const auto& put) {
        for (int y = 0; y < count; ++y) put((this->*row)(y));
      };
    };
    out.position = rows(&MeshOfField::positions, points_);
    if (textured)
      out.uv = rows(&MeshOfField::texture_coordinates, points_);
    else
      out.rgba = rows(&MeshOfField::colours, points_);
    out.index = rows(&MeshOfField::corners, quads_);
    return out;
  }

 private:
  std::vector<float> positions(int y) const {
    std::vector<float> out;
    for (int x = 0; x < points_; ++x)
      out.insert(out.end(), {float(double(x) / quads_), float(field_.at(x, y)), float(-double(y) / quads_)});
    return out;
  }

  std::vector<std::uint16_t> texture_coordinates(int y) const {
    std::vector<std::uint16_t> out;
    for (int x = 0; x < points_; ++x)
      out.insert(out.end(), {std::uint16_t(65535 * x / quads_), std::uint16_t(65535 * y / quads_)});
    return out;
  }

  std::vector<std::uint8_t> colours(int y) const {
    std::vector<std::uint8_t> out;
    for (int x = 0; x < points_; ++x) {
      for (const double c : colour_of(field_.at(x, y), x, y)) out.push_back(std::uint8_t(255 * c));
      out.push_back(255);
    }
    return out;
  }

  std::vector<std::uint32_t> corners(int y) const {
    std::vector<std::uint32_t> out;
    for (int x = 0; x < quads_; ++x) {
      const auto a = std::uint32_t(y * points_ + x), b = a + 1, c = a + std::uint32_t(points_), d = c + 1;
      out.insert(out.end(), {a, b, d, a, d, c});
    }
    return out;
  }

  const HeightField& field_;
  int points_, quads_;
};

void write(const sample::GlbModel& model, const sample::GlbListedMesh& mesh, const std::string& path) {
  Publication publication(path);
  OutputFile file(path, publication.aside());
  write_glb(model, std::span(&mesh, 1), [&](std::span<const std::uint8_t> bytes) { file.write(bytes); });
  file.finish();
  publication.publish();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program{"Writes the benchmark's fractal terrain as a GLB: one unit wide, z up after gigabake's turn."};
  Options o;
  program.add_option("OUT", o.out, "GLB file to write")->required();
  program.add_option("--quads", o.quads, "along an edge, a power of two")
      ->capture_default_str()
      ->check(CLI::Range(2, 8192));
  program.add_option("--texture", o.texture, "texels along an edge of a JPEG texture; 0: vertex colours")
      ->capture_default_str()
      ->check(CLI::Range(0, 16384));
  program.add_option("--seed", o.seed)->capture_default_str();
  program.add_option("--roughness", o.roughness, "of the largest step, of the edge")->capture_default_str();
  program.add_option("--persistence", o.persistence, "roughness of a step over that of twice the step")
      ->capture_default_str();
  CLI11_PARSE(program, argc, argv);
  try {
    if ((o.quads & (o.quads - 1)) != 0) throw UsageError("--quads: expected a power of two");
    sample::GlbModel model;
    model.name = "fractal terrain";
    const HeightField field(o);
    const bool textured = o.texture != 0;
    if (textured) model.images.push_back({"image/jpeg", sample::to_jpeg(picture_of(field, o.texture), 90)});
    model.materials.push_back({"ground", textured ? 0 : -1, {1, 1, 1, 1}, 0, false});
    const MeshOfField field_mesh(field);
    const sample::GlbListedMesh mesh = field_mesh.listed(textured);
    write(model, mesh, o.out);
    fmt::print("{}: {} triangles\n", o.out, mesh.corners / 3);
  } catch (const std::exception& e) {
    fmt::print(stderr, "gigabake_fractal: {}\n", e.what());
    return 1;
  }
  return 0;
}
