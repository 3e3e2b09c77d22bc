/// Outer layers of a content file: a composite contains i3dm or b3dm, which contains GLB, which contains JSON and
/// binary.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "format/source/content/source_bytes.h"
#include "format/source/source.h"
#include "format/source/source_file.h"
#include "format/source/source_files.h"

namespace gigabake {

struct ContentContainer {
  SourceBytes content;              ///< the whole file, or one tile of a composite
  std::string model_uri;            ///< URI of the glTF if an i3dm does not contain it
  std::filesystem::path gltf_file;  ///< URIs in the glTF are relative to it
  SourceBytes gltf;                 ///< a whole GLB, or glTF JSON
  SourceBytes json;                 ///< the JSON text within, in memory
  SourceBytes bin;                  ///< the GLB's binary chunk; empty without one
  bool is_binary = false;
  std::array<double, 3> rtc_center{};  ///< of the feature table of a b3dm or i3dm, in the tile's z-up frame
  bool is_instanced = false;
  std::vector<Affine<World, World>> instances{1};  ///< an i3dm's, in the tile's z-up frame without rtc_center
};

/// Returns the files of the source that a tile belongs to. root: SceneSources::root.
SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root);

/// Opens a content file.
/// Cost    A plain .glb file in a folder is not read into memory, except for its JSON; all other content is.
/// Errors  InputError with the byte at which a length, version or magic number is wrong; as i3dm_instances().
ContentContainer open_container(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
