/// The raw content of a scene.xml and the faults of its text. verify reports all faults; read_scene() rejects faults
/// that would make voxels wrong.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "format/scene/scene_page.h"
#include "format/scene/xml/scene_xml.h"

namespace gigabake {

inline constexpr int newest_scene_version = 7;
/// The first versions with leaves and with classes. A scene gets the lowest version that has its content, so that
/// earlier programs read it. Pages have version newest_page_version.
inline constexpr int first_scene_version_of_leaves = 6, first_scene_version_of_classes = 7;
inline constexpr int newest_page_version = 5;

/// A fault in a scene.xml.
struct SceneFault {
  std::string key, message;                  ///< key: names of the element and the attribute
  std::optional<std::uint64_t> byte_offset;  ///< position of the element
};
InputError error_of(const std::filesystem::path& file, const SceneFault& fault);

/// The summary of all cells and overviews that the root element stores.
struct StoredTotals {
  std::uint64_t cells = 0;
  std::vector<std::uint64_t> voxels;  ///< per lod
  Hash128 content_hash;               ///< content hash of all lods
  std::uint64_t overviews = 0;        ///< 0 before version 3
};

struct SceneReading {
  SceneDescription scene;            ///< cells and overviews that scene.xml itself lists
  std::vector<PageReference> pages;  ///< pages that list the cells; scene.cells is then empty
  int version = newest_scene_version;
  std::optional<StoredTotals> said;   ///< nullopt in version 1
  std::optional<SceneTotals> totals;  ///< stored by version 3 and later
  /// Faults that affect no voxel: unknown or missing parts, or a wrong checksum.
  std::vector<SceneFault> faults;
};

/// Reads scene.xml without its pages.
/// Errors  InputError if the text is not XML or has an unknown version. InputError if an attribute that determines
///         voxels or their positions is missing or malformed, or if the path of a shard leaves the folder.
SceneReading read_scene_text(const std::filesystem::path& path);

/// The raw content of a page.
struct PageReading {
  ScenePage page;
  std::vector<SceneFault> faults;          ///< see SceneReading::faults
  std::vector<SceneFault> contradictions;  ///< faults that read_page() rejects
};
/// Reads a page.
/// Errors  The errors of read_page(), except that contradictions are returned.
PageReading read_page_text(const std::filesystem::path& scene_xml, const SceneHeader& header,
                           const PageReference& reference);

}  // namespace gigabake
