/// The outer layers of a content file: a composite around i3dm or b3dm around GLB around JSON and a binary chunk.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

struct ContentContainer {
  std::vector<std::uint8_t> file;         ///< owns what the spans look at
  std::span<const std::uint8_t> content;  ///< of the file: all of it, or one tile of a composite
  std::string model_uri;                  ///< where an i3dm names its glTF instead of holding it
  std::vector<std::uint8_t> model;        ///< what that file holds
  std::filesystem::path gltf_file;        ///< that URIs in the glTF are relative to
  std::span<const std::uint8_t> gltf;     ///< a whole GLB, or glTF JSON
  std::span<const std::uint8_t> json;     ///< the JSON text within
  std::span<const std::uint8_t> bin;      ///< the GLB's binary chunk; empty without one
  bool is_binary = false;
  std::array<double, 3> rtc_center{};  ///< of the feature table of a b3dm or i3dm, in the tile's z-up frame
  bool is_instanced = false;
  std::vector<Affine<World, World>> instances{1};  ///< an i3dm's, in the tile's z-up frame without rtc_center
};

/// Where a tile's files are, other ones than its content too. root: SceneSources::root.
SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root);

/// Errors  InputError with the byte where a length, version or magic number is wrong; as i3dm_instances().
ContentContainer open_container(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
