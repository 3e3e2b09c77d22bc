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

/// Tiles that are large beside the memory, and about how many bytes of scratch they take: those of their files, as
/// long as these are not packed.
struct ScratchNeed {
  std::uint64_t tiles = 0, bytes = 0;
};
/// Of a rank that may use memory_bytes.
ScratchNeed scratch_need(const SceneSources& sources, std::uint64_t memory_bytes);
/// "about 640.1 MB of scratch for 1 large tile"
std::string scratch_text(const ScratchNeed& need);

/// One line on how much will be kept there; nothing where no tile is that large.
/// Errors  InputError: the disk has less room than that.
std::optional<std::string> scratch_note(const ScratchNeed& need, const std::filesystem::path& folder);

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
