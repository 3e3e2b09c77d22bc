#include "core/base/error.h"
#include "format/export/openvdb/openvdb_export.h"

namespace gigabake {

std::uint64_t export_openvdb(const std::filesystem::path&, int, const std::filesystem::path&, std::uint64_t,
                             const Progress&) {
  throw UsageError(
      "`to` vdb: this build has no OpenVDB (libopenvdb-dev was not installed); `to` nvdb needs no library");
}

std::uint64_t openvdb_memory_bytes() { return 0; }

}  // namespace gigabake
