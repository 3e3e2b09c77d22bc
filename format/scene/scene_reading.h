/// A scene.xml as it stands there: what it says, and what is wrong with it as a text. verify names all of that;
/// read_scene() refuses what a reader of voxels must not believe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "format/scene/scene_page.h"
#include "format/scene/scene_xml.h"
#include "lattice/error.h"

namespace gigabake {

inline constexpr int newest_scene_version = 5;

/// Something in a scene.xml that is not as it should be.
struct SceneFault {
  std::string key, message;                  ///< key: element and attribute
  std::optional<std::uint64_t> byte_offset;  ///< where the element stands
};
InputError error_of(const std::filesystem::path& file, const SceneFault& fault);

/// What the root says of all cells and parents.
struct SaidTotals {
  std::uint64_t cells = 0;
  std::vector<std::uint64_t> voxels;  ///< per lod
  Hash128 content_hash;               ///< of all lods
  std::uint64_t parents = 0;          ///< none before version 3
};

struct SceneReading {
  SceneDescription scene;            ///< with the cells and parents that scene.xml itself lists
  std::vector<PageReference> pages;  ///< in place of cells
  int version = newest_scene_version;
  std::optional<SaidTotals> said;     ///< nothing in version 1
  std::optional<SceneTotals> totals;  ///< all that versions from 3 on say
  /// Parts that we do not know or miss, though no voxel depends on them; a checksum that is wrong.
  std::vector<SceneFault> faults;
};

/// Errors  InputError: not XML, unknown version; an attribute that says where or what voxels are is missing or
///         malformed; shard paths leave the folder.
SceneReading read_scene_text(const std::filesystem::path& path);

/// A page as it stands there.
struct PageReading {
  ScenePage page;
  std::vector<SceneFault> faults;          ///< as SceneReading::faults
  std::vector<SceneFault> contradictions;  ///< what read_page() refuses
};
/// Errors  InputError: as read_page(), but for contradictions.
PageReading read_page_text(const std::filesystem::path& scene_xml, const SceneHeader& header,
                           const PageReference& reference);

}  // namespace gigabake
