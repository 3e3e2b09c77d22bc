#include "scheduler/fingerprint.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "format/bytes.h"

namespace gigabake {

Hash128 cell_fingerprint(const CellJob& job, const BakeParameters& parameters, const std::optional<Geodetic>& origin,
                         std::span<const Hash128> tile_sources) {
  ByteWriter w;
  w.put(kernel_version);
  w.put(to_json(parameters));
  w.put(std::uint8_t(origin.has_value()));
  if (origin) w.put(*origin);
  w.put(job.lattice_min);
  w.put(job.cell_voxels);
  for (const Hash128& source : tile_sources) w.put(source);
  const std::vector<std::uint8_t> bytes = w.take();
  const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
  return {h.low64, h.high64};
}

}  // namespace gigabake
