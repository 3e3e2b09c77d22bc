/// The folder in which a bake keeps the clusters of tiles that are large beside its memory (worker/tiles/tile_store.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cluster/bake.h"
#include "format/source/source.h"

namespace gigabake {

/// OUT/scratch, or in request.scratch a folder that no bake into another OUT has. Empty without OUT.
std::filesystem::path scratch_of(const BakeRequest& request);

/// One line on how much a rank that may use memory_bytes will keep there; nothing where no tile is that large.
/// Errors  InputError: the disk has less room than that.
std::optional<std::string> scratch_note(const SceneSources& sources, const std::filesystem::path& folder,
                                        std::uint64_t memory_bytes);

/// What is in the folder stays for a bake that continues, unless it is said that nobody needs it.
class BakeScratch {
 public:
  explicit BakeScratch(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Removes what a TileStore wrote, and the folder if nothing else is in it.
  ~BakeScratch();
  BakeScratch(const BakeScratch&) = delete;
  BakeScratch& operator=(const BakeScratch&) = delete;

  void is_not_needed() { is_needed_ = false; }

 private:
  const std::filesystem::path folder_;
  bool is_needed_ = true;
};

}  // namespace gigabake
