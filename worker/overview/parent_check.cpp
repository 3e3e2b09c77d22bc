#include "worker/overview/parent_check.h"

#include <optional>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "format/shard/levels/above.h"
#include "format/shard/shard_reader.h"
#include "worker/overview/parent_bake.h"

namespace gigabake {
namespace {

/// The parts of an overview and its children that are compared.
struct OverviewFamily {
  ShardHeader header;
  ParentSource above;
  ChildrenOfParent children;
};
std::optional<OverviewFamily> read_overview_family(const std::filesystem::path& folder, const SceneCell& parent,
                                                   std::span<const SceneCell> children) {
  try {
    const ShardReader reader(folder / parent.file);
    OverviewFamily family{reader.header(), reader.above(), {}};
    for (const SceneCell& child : children)
      family.children.push_back(
          std::make_shared<const ChildOfParent>(read_child(ShardReader(folder / child.file), job_of(parent))));
    return family;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

class Comparison {
 public:
  Comparison(std::filesystem::path file, const SceneCell& parent) : file_(std::move(file)), parent_(parent) {}

  void compare(const OverviewFamily& family, const kernels::CellVolume& made) {
    const std::uint32_t lods = family.header.generator == generator() ? parent_.lods : parent_.copied_lods;
    for (std::uint32_t l = 0; l < lods; ++l)
      if (l >= made.content_hash.size() || made.content_hash[l] != family.header.content_hash[l])
        add("/lod_" + std::to_string(l),
            l < parent_.copied_lods ? "is not a copy of its children's level "
                                    : "does not follow from its children for level ",
            std::to_string(parent_.first_lod + l));
    if (lods == parent_.lods && hash_of(made.above) != hash_of(family.above))
      add("/above", "does not follow from its children for level ", std::to_string(parent_.first_lod + lods - 1));
  }
  void add(const std::string& dataset, const std::string& what, const std::string& more) {
    faults.emplace_back(
        InputError(file_, dataset, what + more + ": a child or this file has changed; remove the file and bake again")
            .what());
  }
  std::vector<std::string> faults;

 private:
  std::filesystem::path file_;
  const SceneCell& parent_;
};

}  // namespace

std::vector<std::string> overview_faults(const std::filesystem::path& folder, const SceneHeader& scene,
                                         const SceneCell& parent, std::span<const SceneCell> children) {
  const std::optional<OverviewFamily> family = read_overview_family(folder, parent, children);
  if (!family) return {};
  Comparison comparison(folder / parent.file, parent);
  try {
    const BakeParameters parameters = parameters_from_json(scene.parameters);
    comparison.compare(*family, make_parent(job_of(parent), family->children, parameters, callers_thread()));
  } catch (const InputError& error) {
    comparison.add("", "cannot be made from its children: ", error.what());
  }
  return std::move(comparison.faults);
}

}  // namespace gigabake
