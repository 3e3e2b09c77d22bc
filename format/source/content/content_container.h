/// The containers in a content file. A composite contains i3dm or b3dm, an i3dm or b3dm contains a GLB, and a GLB
/// contains JSON and binary data.
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
  std::string model_uri;            ///< URI of the glTF if it is outside the i3dm
  std::filesystem::path gltf_file;  ///< URIs in the glTF are relative to this file
  SourceBytes gltf;                 ///< a whole GLB, or glTF JSON
  SourceBytes json;                 ///< the glTF JSON, in memory
  SourceBytes bin;                  ///< the GLB's binary chunk; empty if there is none
  bool is_binary = false;
  std::array<double, 3> rtc_center{};  ///< RTC_CENTER of a b3dm or i3dm, in the tile's z-up frame
  bool is_instanced = false;
  std::vector<Affine<World, World>> instances{1};  ///< of an i3dm: transforms in the tile's z-up frame, without
                                                   ///< rtc_center
  std::vector<std::uint32_t> instance_ids;  ///< of an i3dm: one per instance if the source takes classes from them
  bool has_unused_instance_ids = false;     ///< of an i3dm whose source does not take classes from its ids
};

/// Returns the files of the source that a tile belongs to. `root` is SceneSources::root.
SourceFiles files_of(const TileRef& tile, const std::filesystem::path& root);

/// Opens a content file.
/// Cost    Only the JSON of a plain .glb file in a folder is read into memory. All other content is read completely.
/// Errors  InputError with the byte offset of a wrong length, version or magic number. Also InputError like
///         i3dm_instances().
ContentContainer open_container(const TileRef& tile, const SourceFiles& files);

}  // namespace gigabake
