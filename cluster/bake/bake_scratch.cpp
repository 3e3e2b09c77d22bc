#include "cluster/bake/bake_scratch.h"

#include <system_error>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/pluralize.h"
#include "format/system/hash_bytes.h"
#include "worker/tiles/tile_store.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

bool is_of_store(const std::string& name) {
  const auto is_one = [&](const char* begin, const std::string& end) {
    return (name.starts_with(begin) && (name.ends_with(end) || name.ends_with(end + ".lock"))) ||
           (name.starts_with(std::string(".") + begin) && name.ends_with(".part"));
  };
  return is_one("t_", ".clusters") || is_one("x_", ".texture");
}

/// Returns the free bytes of the disk on which `folder` is or would be created; nullopt if they are unknown.
std::optional<std::uint64_t> room_at(fs::path folder) {
  std::error_code error;
  folder = fs::absolute(folder, error);
  while (!folder.empty() && !fs::exists(folder, error) && folder != folder.parent_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, error);
  if (error) return std::nullopt;
  return space.available;
}

}  // namespace

fs::path scratch_of(const BakeRequest& request) {
  if (request.out.empty()) return {};
  if (request.scratch.empty()) return request.out / "scratch";
  const std::string out = fs::weakly_canonical(fs::absolute(request.out)).string();
  const Hash128 hash = hash_of_bytes({reinterpret_cast<const std::uint8_t*>(out.data()), out.size()});
  return request.scratch / ("gigabake-" + hash.hex());
}

ScratchNeed scratch_need(const SceneSources& sources, std::uint64_t memory_bytes) {
  const std::uint64_t maximum = scratch_in({}, memory_bytes).max_tile_bytes;
  ScratchNeed need;
  for (const TileRef& tile : sources.tiles)
    if (tile.bytes > maximum) ++need.tiles, need.bytes += tile.bytes;
  return need;
}

std::string describe_scratch(const ScratchNeed& need) {
  return "about " + readable_size(need.bytes) + " of scratch for " + pluralize(need.tiles, "large tile");
}

std::optional<std::string> scratch_info(const ScratchNeed& need, const fs::path& folder) {
  if (folder.empty() || need.tiles == 0) return std::nullopt;
  const std::string wanted = describe_scratch(need);
  if (const auto room = room_at(folder); room && *room < need.bytes)
    throw InputError(folder, "",
                     wanted + " do not fit on a disk that has " + readable_size(*room) +
                         " left; name another folder with `scratch` or raise `memory_bytes`");
  return wanted + " in " + folder.string() + " while cells are baked, and 7 bytes per texel of large textures";
}

BakeScratch::~BakeScratch() {
  if (is_needed_ || folder_.empty()) return;
  std::error_code error;  // failures to remove files are harmless
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    if (is_of_store(it->path().filename().string())) fs::remove(it->path(), ignored);
  }
  fs::remove(folder_, error);
}

}  // namespace gigabake
