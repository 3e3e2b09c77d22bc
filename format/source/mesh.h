/// A decoded content file: triangles, materials and encoded images. The coordinates are read from the file unchanged;
/// affine maps place them in the scene. The vertices are not yet transformed or snapped.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/rules.h"
#include "core/math/frames.h"
#include "core/math/octahedral.h"
#include "core/octree/octree.h"

namespace gigabake {

struct TextureUse {
  int image = -1;  ///< index into TileMesh::images; -1: none
  Wrap wrap_s = Wrap::repeat, wrap_t = Wrap::repeat;
  bool nearest = false;  ///< magFilter NEAREST
};

/// A texture whose texels are directions in the surface's tangent frame.
struct NormalMap {
  TextureUse texture;
  float scale = 1;  ///< factor of x and y; finite
};

struct TexelIds;  // core/octree/texel_ids.h

/// A texture whose texels are ids that classes are taken from.
struct IdTexture {
  TextureUse texture;
  std::shared_ptr<const TexelIds> ids;  ///< null if there is no texture
};

/// The value of a class or level that is not stated.
inline constexpr std::int32_t not_stated = -1;

/// The coarsest level of the largest cell.
inline constexpr int max_source_lod = 10;

struct Material {
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< linear RGB and alpha factor, each clamped to 0…1
  TextureUse texture;
  NormalMap normal_map;
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;
  std::int32_t voxel_class = not_stated;  ///< class of its name (source_classes.h)
};

/// A triangle list. Every index is less than the number of vertices. Strips and fans are expanded.
struct Primitive {
  std::vector<float> position;       ///< 3 per vertex, metres in Local; snap drops and counts vertices with NaN or Inf
  float position_step = 0;           ///< distance of adjacent values in the file; 0: that of adjacent floats
  std::vector<std::uint32_t> index;  ///< 3 per triangle, counter-clockwise seen from outside
  std::vector<float> uv;             ///< 2 per vertex, or empty; the base colour's set, after KHR_texture_transform
  std::vector<std::uint16_t> rgba;   ///< 4 per vertex, linear, 65535 = 1, or empty
  std::vector<VertexNormal> normal;  ///< 1 per vertex, or empty; a vertex may have none
  std::vector<float> normal_uv;      ///< coordinates of the normal map: 2 per vertex, or empty
  bool shares_uv = false;            ///< `uv` has the coordinates of the normal map; `normal_uv` is empty
  std::vector<VertexTangent> tangent;         ///< 1 per vertex, or empty; a vertex may have none
  std::vector<VoxelClass> vertex_class = {};  ///< 1 per vertex, only while a reader splits the primitive by classes
  int material = 0;                           ///< index into TileMesh::materials (always valid)
  std::int32_t voxel_class = not_stated;      ///< class of its ids (source_classes.h), before that of its material
  IdTexture id_texture = {};                  ///< classes of its texels, before all other classes
  std::vector<float> id_uv = {};              ///< coordinates of `id_texture`: 2 per vertex, or empty
};

/// Max triangles of a part that a PrimitiveSink (source.h) receives. A part has only the vertices that it uses.
inline constexpr std::uint64_t max_part_triangles = std::uint64_t(1) << 18;

/// One placement of a primitive.
struct Instance {
  int primitive = 0;
  Affine<Scene, Local> scene_from_local;  ///< if its determinant is negative, the caller reverses the winding
  std::int32_t lod = not_stated;          ///< level of its material or node (named_voxel_sizes.h)
  std::int32_t voxel_class = not_stated;  ///< class of its id (instance_ids.h), before all other classes
};

/// Max placements in a file. A few bytes of a file can place a mesh again, so placements are also limited by
/// memory_limit().
inline constexpr std::size_t max_placements = std::size_t(1) << 24;
/// Bytes of an Instance and of related data in readers and scans.
inline constexpr std::size_t placement_bytes = 192;

/// An image in its file's encoding: PNG, JPEG or WebP, recognized by content.
struct EncodedImage {
  std::string name;  ///< for messages: "tile.glb: images[2]"
  std::vector<std::uint8_t> bytes;
};

/// One class of parts of a source that a bake ignores or changes.
struct SourceWarning {
  std::string text;          ///< the class, e.g. "lines not understood"; equal texts of several sources are one message
  std::uint64_t count = 0;   ///< number of such parts; 0: `text` is the whole message
  std::uint64_t of = 0;      ///< total number of such parts; 0: not stated
  std::string example = {};  ///< the first such part, e.g. "line 12" or "'bark'"
  bool is_loss = false;      ///< triangles are missing: the scene is incomplete, and the exit status is 3

  SourceWarning() = default;
  // These constructors are implicit, because most warnings are only a text.
  SourceWarning(std::string whole) : text(std::move(whole)) {}
  SourceWarning(const char* whole) : text(whole) {}

  /// Returns "TEXT: COUNT of OF, e.g. EXAMPLE", without the parts that are not stated.
  std::string line() const;

  friend bool operator==(const SourceWarning&, const SourceWarning&) = default;
};

struct TileCounts {
  std::uint64_t triangles = 0;       ///< sum over all instances
  std::uint64_t skipped_points = 0;  ///< points, which are not baked
  std::uint64_t skipped_lines = 0;   ///< line segments, which are not baked
};

struct TileMesh {
  std::vector<Primitive> primitives;
  std::vector<Instance> instances;
  std::vector<Material> materials;  ///< at least one
  std::vector<EncodedImage> images;
  TileCounts counts;
  std::vector<SourceWarning> warnings;  ///< without the file's name
  /// Indices in SourceClasses::of_materials of the names that the file has, ascending.
  std::vector<std::uint32_t> classified = {};
  /// Numbers in NamedVoxelSizes of the names that the file has, ascending.
  std::vector<std::uint32_t> sized = {};
};

/// Grey of an object whose material or image is missing: sRGB code 127 as linear value.
inline constexpr float grey_without_image = 0.2122f;

/// A decoded image with straight alpha and the stored sRGB codes. Row 0 is first.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< 4 · width · height
  bool has_alpha = false;          ///< some texel's alpha is below 255
};

/// Decodes an image.
/// Errors  InputError: the image is not a whole PNG, JPEG or WebP (if built with libwebp), or has more than 2^28
///         texels.
Image decode_image(const EncodedImage& image);

}  // namespace gigabake
