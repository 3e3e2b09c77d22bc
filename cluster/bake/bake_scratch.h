/// The scratch folder of a bake, for clusters of tiles that are large compared with the memory
/// (worker/tiles/tile_store.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cluster/bake/bake.h"
#include "format/source/source.h"

namespace gigabake {

/// Returns OUT/scratch, or a folder in request.scratch that is unique to OUT. Returns an empty path if there is no OUT.
std::filesystem::path scratch_of(const BakeRequest& request);

/// Tiles that are large compared with the memory, and their approximate scratch size. The size is that of the tiles'
/// files; it is too small for compressed files.
struct ScratchNeed {
  std::uint64_t tiles = 0, bytes = 0;
};
/// Returns the scratch need of a rank with `memory_bytes`.
ScratchNeed scratch_need(const SceneSources& sources, std::uint64_t memory_bytes);
/// Returns, for example, "about 640.1 MB of scratch for 1 large tile".
std::string describe_scratch(const ScratchNeed& need);

/// Returns one line with the scratch size and folder; nullopt if no tile is large.
/// Errors  InputError: the disk has less free space than the scratch size.
std::optional<std::string> scratch_info(const ScratchNeed& need, const std::filesystem::path& folder);

/// Owner of the scratch folder. Files are kept for a resumed bake unless is_not_needed() is called.
class BakeScratch {
 public:
  explicit BakeScratch(std::filesystem::path folder) : folder_(std::move(folder)) {}
  /// Removes the files that a TileStore wrote, and then the folder if it is empty. Does so only if is_not_needed() was
  /// called.
  ~BakeScratch();
  BakeScratch(const BakeScratch&) = delete;
  BakeScratch& operator=(const BakeScratch&) = delete;

  void is_not_needed() { is_needed_ = false; }

 private:
  const std::filesystem::path folder_;
  bool is_needed_ = true;
};

}  // namespace gigabake
