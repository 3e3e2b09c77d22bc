#include "app/manual/about.h"

#include <fmt/format.h>
#include <gigabake_commit.h>

#include "app/manual/library_versions.h"
#include "cluster/mpi/mpi_version.h"
#include "format/scene/xml/scene_reading.h"
#include "format/shard/shard_layout.h"
#include "kernels/cuda/device/build.h"

namespace gigabake::app {
namespace {

using Versions = std::vector<std::pair<std::string, std::string>>;

std::string listed(const Versions& versions) {
  std::string text;
  for (const auto& [name, version] : versions)
    text += (text.empty() ? "" : ", ") + name + (version.empty() ? ": not built in" : " " + version);
  return text;
}

std::string cuda() {
  const kernels::CudaBuild build = kernels::cuda_build();
  if (build.toolkit.empty()) return "not built in: the CPU bakes cells and renders images";
  return fmt::format("toolkit {}, for GPU architectures {}", build.toolkit, build.architectures);
}

std::string mpi() { return has_mpi() ? mpi_version() : "not built in: one process bakes, with threads"; }

std::string compiler() {
#ifdef __clang__
  const std::string name = "clang " __clang_version__;
#else
  const std::string name = fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
  const std::string march = GIGABAKE_MARCH;
  return march.empty() ? name : name + " for " + march;
}

}  // namespace

std::string build_version() {
  const std::string commit = GIGABAKE_COMMIT;
  return commit.empty() ? GIGABAKE_VERSION : GIGABAKE_VERSION ", commit " + commit;
}

std::string about() {
  const LibraryVersions libraries = library_versions();
  return fmt::format(
      "gigabake {}\n"
      "formats   shards: writes version {}, reads {} to {}; scenes: writes version {} (docs/format.md)\n"
      "compiler  {}\n"
      "CUDA      {}\n"
      "MPI       {}\n"
      "libraries {}\n"
      "loaded    when needed: {}\n"
      "codecs    {}",
      build_version(), shard_version, oldest_shard_version, shard_version, newest_scene_version, compiler(), cuda(),
      mpi(), listed(libraries.linked), listed(libraries.loaded), libraries.codecs.empty() ? "none" : libraries.codecs);
}

}  // namespace gigabake::app
