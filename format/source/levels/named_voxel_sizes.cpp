#include "format/source/levels/named_voxel_sizes.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/usage_errors.h"

namespace gigabake {
namespace {

using OfName = NamedVoxelSizes::OfName;

constexpr const char *member_of_materials = "voxel_size_of_material", *member_of_nodes = "voxel_size_of_node";
constexpr double min_size_m = 1e-6, max_size_m = 1e6;

std::vector<OfName> sizes_in(const JsonMembers& source, const char* member) {
  std::vector<OfName> sizes;
  if (!source.has(member)) return sizes;
  const JsonMembers names = source.members(member);
  for (const auto& item : source.object(member).items()) {
    const std::string& name = item.key();
    const auto metres = item.value().is_number() ? item.value().get<double>() : 0;
    if (!(metres >= min_size_m && metres <= max_size_m)) names.fail(name, "expected 1e-6 to 1e6 metres");
    OfName& size = sizes.emplace_back();
    size.name = name;
    size.size = {source.file(), names.path_of(name), metres};
  }
  std::ranges::sort(sizes, {}, &OfName::name);
  return sizes;
}

std::int32_t lod_of_name(const std::vector<OfName>& sizes, std::string_view name) {
  const auto at = std::ranges::lower_bound(sizes, name, {}, &OfName::name);
  return at == sizes.end() || at->name != name ? not_stated : std::int32_t(at->lod);
}

nlohmann::json lods_of(const std::vector<OfName>& sizes, const std::set<std::string>* names) {
  nlohmann::json lods;
  for (const OfName& size : sizes)
    if (names == nullptr || names->contains(size.name)) lods[size.name] = size.lod;
  return lods;
}

std::string text_of(const NamedVoxelSizes& sizes, const std::set<std::string>* materials,
                    const std::set<std::string>* nodes) {
  nlohmann::json out;
  if (auto lods = lods_of(sizes.of_materials, materials); !lods.empty()) out["materials"] = std::move(lods);
  if (auto lods = lods_of(sizes.of_nodes, nodes); !lods.empty()) out["nodes"] = std::move(lods);
  return out.empty() ? std::string() : out.dump();
}

std::vector<OfName> lods_in(const JsonMembers& all, const char* member) {
  std::vector<OfName> sizes;
  for (const auto& item : all.object(member).items()) {
    const auto& lod = item.value();
    if (!lod.is_number_unsigned() || lod.get<std::uint64_t>() > std::uint64_t(max_source_lod))
      all.members(member).fail(item.key(), "expected a level of a cell");
    OfName& size = sizes.emplace_back();
    size.name = item.key();
    size.lod = lod.get<std::uint8_t>();
  }
  std::ranges::sort(sizes, {}, &OfName::name);
  return sizes;
}

[[noreturn]] void refuse_member(const NamedVoxelSizes& sizes, const char* member, const std::string& message) {
  throw UsageError(InputError(sizes.file, sizes.key + "." + member, message).what());
}

}  // namespace

bool NamedVoxelSizes::has_coarse() const {
  const auto is_coarse = [](const OfName& size) { return size.lod != 0; };
  return std::ranges::any_of(of_materials, is_coarse) || std::ranges::any_of(of_nodes, is_coarse);
}

void NamedVoxelSizes::refuse_unknown(std::size_t name) const {
  const bool is_material = name < of_materials.size();
  const OfName& size = is_material ? of_materials[name] : of_nodes.at(name - of_materials.size());
  refuse_member(
      *this, is_material ? member_of_materials : member_of_nodes,
      std::string(is_material ? "no material" : "no node") + " of the source has the name " + in_quotes(size.name));
}

std::shared_ptr<const NamedVoxelSizes> named_voxel_sizes_of(const JsonMembers& source) {
  return with_usage_errors([&]() -> std::shared_ptr<const NamedVoxelSizes> {
    NamedVoxelSizes sizes{sizes_in(source, member_of_materials), sizes_in(source, member_of_nodes), source.file(),
                          source.path()};
    return sizes.names() == 0 ? nullptr : std::make_shared<const NamedVoxelSizes>(std::move(sizes));
  });
}

std::int32_t lod_of_material(const NamedVoxelSizes* sizes, std::string_view name) {
  return sizes == nullptr ? not_stated : lod_of_name(sizes->of_materials, name);
}

std::int32_t lod_of_node(const NamedVoxelSizes* sizes, std::string_view name) {
  return sizes == nullptr ? not_stated : lod_of_name(sizes->of_nodes, name);
}

bool may_have_levels(const TileRef& tile) {
  return tile.lod != 0 || (tile.named_sizes != nullptr && tile.named_sizes->has_coarse());
}

std::vector<std::uint32_t> sized_names(const NamedVoxelSizes* sizes, const std::set<std::string>& materials,
                                       const std::set<std::string>& nodes) {
  std::vector<std::uint32_t> found;
  if (sizes == nullptr) return found;
  const auto add = [&found](const std::vector<OfName>& stated, const std::set<std::string>& names, std::size_t first) {
    for (std::size_t i = 0; i < stated.size(); ++i)
      if (names.contains(stated[i].name)) found.push_back(std::uint32_t(first + i));
  };
  add(sizes->of_materials, materials, 0);
  add(sizes->of_nodes, nodes, sizes->of_materials.size());
  return found;
}

void expect_no_nodes(const TileRef& tile) {
  if (tile.named_sizes && !tile.named_sizes->of_nodes.empty())
    refuse_member(*tile.named_sizes, member_of_nodes, tile.name + " has no nodes; only glTF and OBJ have them");
}

std::string to_json(const NamedVoxelSizes& sizes) { return text_of(sizes, nullptr, nullptr); }

std::string to_json(const NamedVoxelSizes& sizes, const std::set<std::string>& materials,
                    const std::set<std::string>& nodes) {
  return text_of(sizes, &materials, &nodes);
}

NamedVoxelSizes named_voxel_sizes_from_json(const std::string& text) {
  return with_usage_errors([&] {
    const std::filesystem::path file = "the voxel sizes of names";
    const nlohmann::json json = parse_json_object(file, text);
    const JsonMembers all(file, json);
    all.only({"materials", "nodes"});
    return NamedVoxelSizes{lods_in(all, "materials"), lods_in(all, "nodes"), {}, {}};
  });
}

}  // namespace gigabake
