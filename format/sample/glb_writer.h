/// A small writer of binary glTF 2.0: what the sample and the benchmark meshes need, and no more.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace gigabake::sample {

struct GlbImage {
  std::string mime;  ///< "image/jpeg" or "image/png"
  std::vector<std::uint8_t> bytes;
  /// Where the image stands as a file, relative to the GLB; empty: the GLB holds `bytes`.
  std::string uri{};
};

struct GlbMaterial {
  std::string name;
  int image = -1;                                ///< index into GlbModel::images; -1: none
  std::array<double, 4> base_color{1, 1, 1, 1};  ///< linear
  double alpha_cutoff = 0;                       ///< > 0: alphaMode MASK
  bool double_sided = false;
  bool blended = false;  ///< alphaMode BLEND: base_color's alpha counts
};

/// A triangle list in glTF's axes: y up, metres, counter-clockwise seen from outside.
struct GlbMesh {
  int material = 0;
  std::vector<float> position;     ///< 3 per vertex
  std::vector<std::uint16_t> uv;   ///< 2 per vertex, 65535 = 1; or empty
  std::vector<std::uint8_t> rgba;  ///< 4 per vertex, linear, 255 = 1; or empty
  std::vector<std::uint32_t> index;
  std::size_t vertices() const { return position.size() / 3; }
};

struct GlbModel {
  std::string name;
  std::array<double, 3> translation_m{};  ///< of the one node that holds the meshes
  std::vector<GlbMesh> meshes;            ///< empty ones are left out
  std::vector<GlbMaterial> materials;
  std::vector<GlbImage> images;
};

/// Values that are made while they are written, piece by piece in their order.
template <class T>
using GlbPut = std::function<void(std::span<const T>)>;
template <class T>
using GlbList = std::function<void(const GlbPut<T>& put)>;

/// As GlbMesh, of which nothing is held. A list without a function: the mesh has none.
struct GlbListedMesh {
  int material = 0;
  std::size_t vertices = 0, corners = 0;
  std::array<float, 3> low{}, high{};  ///< of the positions
  GlbList<float> position;
  GlbList<std::uint16_t> uv;
  GlbList<std::uint8_t> rgba;
  GlbList<std::uint32_t> index;
};

/// Writes the model with these meshes in place of its own: the same bytes as to_glb() makes of the same values.
/// Cost  Memory for the images, whatever the meshes' size.
/// Errors  as to_glb(), before anything is written; what `put` throws.
void write_glb(const GlbModel& model, std::span<const GlbListedMesh> meshes, const GlbPut<std::uint8_t>& put);

/// The file's bytes. Indices are 16 bit where they fit.
/// Errors  UsageError where the model exceeds the 4 GiB that a GLB can hold.
std::vector<std::uint8_t> to_glb(const GlbModel& model);

}  // namespace gigabake::sample
