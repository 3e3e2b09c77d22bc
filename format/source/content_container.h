/// The outer layers of a content file: a composite around i3dm or b3dm around GLB around JSON and a binary chunk.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/source/source.h"
#include "format/source/source_bytes.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

struct ContentContainer {
  SourceBytes content;              ///< of the file: all of it, or one tile of a composite
  std::string model_uri;            ///< where an i3dm names its glTF instead of holding it
  std::filesystem::path gltf_file;  ///< that URIs in the glTF are relative to
  SourceBytes gltf;                 ///< a whole GLB, or glTF JSON
  SourceBytes json;                 ///< the JSON text within, in memory
  SourceBytes bin;                  ///< the GLB's binary chunk; empty without one
  bool is_binary = false;
  std::array<double, 3> rtc_center{};  ///< of the feature table of a b3dm or i3dm, in the tile's z-up frame
  bool is_instanced = false;
  std::vector<Affine<World, World>> instances{1};  ///< an i3dm's, in the tile's z-up frame without rtc_center
};

/// Where a tile's files are, other ones than its content too. root: SceneSources::root.
SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root);

/// Cost  A GLB that is a file of its own stays in it, but for its JSON; everything else is read into memory.
/// Errors  InputError with the byte where a length, version or magic number is wrong; as i3dm_instances().
ContentContainer open_container(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
