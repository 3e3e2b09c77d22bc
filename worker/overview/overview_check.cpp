#include "worker/overview/overview_check.h"

#include <optional>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "format/shard/levels/above.h"
#include "format/shard/shard_reader.h"
#include "worker/overview/overview_bake.h"

namespace gigabake {
namespace {

/// The parts of an overview and its children that are compared.
struct OverviewFamily {
  ShardHeader header;
  DownsampleState above;
  OverviewChildren children;
};
std::optional<OverviewFamily> read_overview_family(const std::filesystem::path& folder, const SceneCell& overview,
                                                   std::span<const SceneCell> children) {
  try {
    const ShardReader reader(folder / overview.file);
    OverviewFamily family{reader.header(), reader.above(), {}};
    for (const SceneCell& child : children)
      family.children.push_back(
          std::make_shared<const OverviewChild>(read_child(ShardReader(folder / child.file), job_of(overview))));
    return family;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

class Comparison {
 public:
  Comparison(std::filesystem::path file, const SceneCell& overview) : file_(std::move(file)), overview_(overview) {}

  void compare(const OverviewFamily& family, const kernels::CellVolume& made) {
    const std::uint32_t lods = family.header.generator == generator() ? overview_.lods : overview_.copied_lods;
    for (std::uint32_t l = 0; l < lods; ++l)
      if (l >= made.content_hash.size() || made.content_hash[l] != family.header.content_hash[l])
        add("/lod_" + std::to_string(l),
            l < overview_.copied_lods ? "is not a copy of its children's level "
                                      : "does not follow from its children for level ",
            std::to_string(overview_.first_lod + l));
    if (lods == overview_.lods && hash_of(made.above) != hash_of(family.above))
      add("/above", "does not follow from its children for level ", std::to_string(overview_.first_lod + lods - 1));
  }
  void add(const std::string& dataset, const std::string& what, const std::string& more) {
    faults.emplace_back(
        InputError(file_, dataset, what + more + ": a child or this file has changed; remove the file and bake again")
            .what());
  }
  std::vector<std::string> faults;

 private:
  std::filesystem::path file_;
  const SceneCell& overview_;
};

}  // namespace

std::vector<std::string> overview_faults(const std::filesystem::path& folder, const SceneHeader& scene,
                                         const SceneCell& overview, std::span<const SceneCell> children) {
  const std::optional<OverviewFamily> family = read_overview_family(folder, overview, children);
  if (!family) return {};
  Comparison comparison(folder / overview.file, overview);
  try {
    const BakeParameters parameters = parameters_from_json(scene.parameters);
    comparison.compare(*family, make_overview(job_of(overview), family->children, parameters, callers_thread()));
  } catch (const InputError& error) {
    comparison.add("", "cannot be made from its children: ", error.what());
  }
  return std::move(comparison.faults);
}

}  // namespace gigabake
