/// Is a scene whole? Every checksum, reference and invariant of its shards.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "format/scene/missing_data.h"
#include "format/scene/scene_xml.h"
#include "lattice/progress.h"

namespace gigabake {

struct VerifyResult {
  std::uint64_t cells = 0, voxels = 0, bytes = 0;  ///< as scene.xml says
  bool has_totals = true;           ///< scene.xml says how many cells there are: without, a lost one is not seen
  MissingData missing;              ///< as scene.xml says
  std::vector<std::string> faults;  ///< one line each: file, dataset, what is wrong; in the scene's order
};

/// What is wrong with a parent beside its children, one line each. Called from several threads at once.
/// children: the cells or parents right below it that its window overlaps.
using ParentCheck = std::function<std::vector<std::string>(const SceneHeader& scene, const SceneCell& parent,
                                                           std::span<const SceneCell> children)>;

/// Reads every shard whole and compares it with what scene.xml says, hashes of the voxels included.
/// Cost  one read of all shards; one cell in memory for each of `threads`.
/// Errors  InputError when scene.xml itself cannot be read; faults of shards are listed. Stopped.
VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads, const Progress& progress = {},
                          const ParentCheck& check_parent = {});

}  // namespace gigabake
