/// Edits of a scene: an ordered list of changes of its voxels at lod 0, by type and shape.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/rules.h"
#include "core/io/hash128.h"

namespace gigabake {

/// The change of the voxels that an edit selects.
enum class EditType : std::uint8_t {
  carve,  ///< removes them
  fill,   ///< makes them opaque, with a colour and a normal, whether they existed or not
  paint,  ///< replaces the colour, alpha and class of existing voxels, as far as the edit states them
};
template <>
constexpr auto names_of<EditType>() {
  return std::to_array<std::string_view>({"carve", "fill", "paint"});
}

/// The coordinates of a shape: metres of the scene's frame, or longitude and latitude in degrees and metres above the
/// WGS84 ellipsoid.
enum class EditFrame : std::uint8_t { scene, degrees };

/// A half-open box along the axes of its frame.
struct BoxShape {
  std::array<double, 3> low{}, high{};
};

struct SphereShape {
  std::array<double, 3> centre{};
  double radius_m = 0;
};

/// An upright cylinder. In degrees, its axis is vertical at its base.
struct CylinderShape {
  std::array<double, 3> base{};
  double radius_m = 0, height_m = 0;
};

/// A polygon with holes between two heights.
struct PrismShape {
  using Ring = std::vector<std::array<double, 2>>;
  std::vector<Ring> rings;  ///< the outer ring first; without repeated last positions
  double low_m = 0, high_m = 0;
};

/// A closed triangle mesh. In degrees, its positions are metres east, north and up of `place`.
struct MeshShape {
  std::array<double, 3> place{};  ///< longitude, latitude, height; only in degrees
  std::vector<std::array<double, 3>> positions_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

using EditShape = std::variant<BoxShape, SphereShape, CylinderShape, PrismShape, MeshShape>;

struct Edit {
  EditType type = EditType::carve;
  EditFrame frame = EditFrame::scene;
  EditShape shape;
  std::array<std::uint8_t, 3> rgb{};              ///< sRGB; for fill and paint
  std::optional<std::uint8_t> alpha = {};         ///< 1 … 255; for paint
  bool has_rgb = true;                            ///< false: a paint that changes only the class, and perhaps alpha
  std::optional<std::uint16_t> voxel_class = {};  ///< for fill and paint
  std::filesystem::path file = {};                ///< where the edit is listed, for messages
  std::string key = {};                           ///< its key in the file, such as "edits[3]"
};

using EditList = std::vector<Edit>;

/// Returns the hash of an edit, which does not depend on its file and key.
Hash128 hash_of(const Edit& edit);

/// Throws the error of a wrong edit: UsageError with the edit's file, its key and the message.
[[noreturn]] void refuse(const Edit& edit, const std::string& message);

}  // namespace gigabake
