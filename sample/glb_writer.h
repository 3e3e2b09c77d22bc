/// A minimal writer of binary glTF 2.0 for the sample and the benchmark meshes.
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
  /// Path of the image file relative to the GLB; empty: the GLB contains `bytes`.
  std::string uri{};
};

struct GlbMaterial {
  std::string name;
  int image = -1;                                ///< index into GlbModel::images; -1: none
  std::array<double, 4> base_color{1, 1, 1, 1};  ///< linear
  double alpha_cutoff = 0;                       ///< > 0: alphaMode MASK
  bool double_sided = false;
  bool blended = false;  ///< alphaMode BLEND: uses base_color's alpha
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
  std::array<double, 3> translation_m{};  ///< translation of the only node, which has all meshes
  std::vector<GlbMesh> meshes;            ///< empty meshes are omitted
  std::vector<GlbMaterial> materials;
  std::vector<GlbImage> images;
};

/// A consumer of values that are generated during writing. It receives them in consecutive pieces.
template <class T>
using GlbPut = std::function<void(std::span<const T>)>;
template <class T>
using GlbList = std::function<void(const GlbPut<T>& put)>;

/// A mesh like GlbMesh whose values are generated during writing. An empty function means that the mesh lacks this
/// list.
struct GlbListedMesh {
  int material = 0;
  std::size_t vertices = 0, corners = 0;
  std::array<float, 3> low{}, high{};  ///< bounds of the positions
  GlbList<float> position;
  GlbList<std::uint16_t> uv;
  GlbList<std::uint8_t> rgba;
  GlbList<std::uint32_t> index;
};

/// Writes the model with `meshes` instead of the model's own meshes. Writes the same bytes as to_glb() for the same
/// values.
/// Cost    Memory for the images only, independent of the meshes' size.
/// Errors  UsageError as in to_glb(), before any byte is written; exceptions of `put`.
void write_glb(const GlbModel& model, std::span<const GlbListedMesh> meshes, const GlbPut<std::uint8_t>& put);

/// Returns the bytes of the file. Uses 16-bit indices if they suffice.
/// Errors  UsageError if the model exceeds the 4 GiB limit of a GLB.
std::vector<std::uint8_t> to_glb(const GlbModel& model);

}  // namespace gigabake::sample
