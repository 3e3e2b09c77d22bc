/// Is a scene whole? Every checksum, reference and invariant of its shards.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lattice/progress.h"

namespace gigabake {

struct VerifyResult {
  std::uint64_t cells = 0, voxels = 0, bytes = 0;  ///< as scene.xml says
  bool has_totals = true;           ///< scene.xml says how many cells there are: without, a lost one is not seen
  std::vector<std::string> faults;  ///< one line each: file, dataset, what is wrong; in the scene's order
};

/// Reads every shard whole and compares it with what scene.xml says, hashes of the voxels included.
/// Cost  one read of all shards; one cell in memory for each of `threads`.
/// Errors  InputError when scene.xml itself cannot be read; faults of shards are listed. Stopped.
VerifyResult verify_scene(const std::filesystem::path& scene_xml, int threads, const Progress& progress = {});

}  // namespace gigabake
