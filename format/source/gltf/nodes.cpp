#include "format/source/gltf/nodes.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/math/transform.h"
#include "format/source/classes/instance_ids.h"
#include "format/source/gltf/accessor.h"
#include "format/source/levels/named_voxel_sizes.h"
#include "format/source/mesh.h"

namespace gigabake {
namespace {

using Map = Affine<Gltf, Local>;

template <std::size_t N>
std::array<double, N> numbers_or(const std::vector<double>& v, const std::array<double, N>& otherwise) {
  std::array<double, N> out = otherwise;
  if (v.size() == N) std::copy(v.begin(), v.end(), out.begin());
  return out;
}

Affine<Local, Local> node_map(const tinygltf::Node& n) {
  if (n.matrix.size() == 16) return affine_from_columns<Local, Local>(n.matrix);
  return affine_from_trs<Local, Local>(numbers_or<3>(n.translation, {0, 0, 0}), numbers_or<4>(n.rotation, {0, 0, 0, 1}),
                                       numbers_or<3>(n.scale, {1, 1, 1}));
}

std::vector<int> root_nodes(const tinygltf::Model& model) {
  if (!model.scenes.empty()) return model.scenes[std::size_t(std::max(0, model.defaultScene))].nodes;
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& n : model.nodes)
    for (const int child : n.children) is_child[std::size_t(child)] = true;
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i)
    if (!is_child[i]) roots.push_back(int(i));
  return roots;
}

/// Returns whether the node is visible.
/// Source  KHR_node_visibility: an invisible node hides all nodes below it.
bool is_visible(const tinygltf::Node& n) {
  const auto extension = n.extensions.find("KHR_node_visibility");
  if (extension == n.extensions.end() || !extension->second.Has("visible")) return true;
  const tinygltf::Value& visible = extension->second.Get("visible");
  return !visible.IsBool() || visible.Get<bool>();
}

/// The instances of a node by EXT_mesh_gpu_instancing. A node without the extension has one instance.
class NodeInstances {
 public:
  NodeInstances(const std::filesystem::path& file, const GltfDocument& document, const tinygltf::Node& n,
                MemoryClaim& claim) {
    const auto extension = n.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == n.extensions.end() || !extension->second.Has("attributes")) return;
    const tinygltf::Value& attributes = extension->second.Get("attributes");
    const auto read = [&](const char* name, int components) {
      if (!attributes.Has(name)) return std::vector<float>();
      const int accessor = attributes.Get(name).GetNumberAsInt();
      const AccessorItems items(file, document, accessor);
      if (items.components() != components)
        throw InputError(file, "EXT_mesh_gpu_instancing." + std::string(name),
                         "expected VEC" + std::to_string(components));
      claim.add_items(items.count(), std::uint64_t(components) * sizeof(float), "nodes", "instances of a node");
      return items.floats(components);
    };
    t_ = read("TRANSLATION", 3), q_ = read("ROTATION", 4), s_ = read("SCALE", 3);
    count_ = std::max({t_.size() / 3, q_.size() / 4, s_.size() / 3});
    if (t_.empty() && q_.empty() && s_.empty()) count_ = count_of_others(file, document, attributes);
    const auto fits = [this](std::size_t items) { return items == 0 || items == count_; };
    if (!fits(t_.size() / 3) || !fits(q_.size() / 4) || !fits(s_.size() / 3))
      throw InputError(file, "EXT_mesh_gpu_instancing", "TRANSLATION, ROTATION and SCALE differ in length");
  }

  /// Returns the number of instances without transforms, which further attributes such as _FEATURE_ID_0 state.
  static std::size_t count_of_others(const std::filesystem::path& file, const GltfDocument& document,
                                     const tinygltf::Value& attributes) {
    const std::vector<std::string> names = attributes.Keys();
    if (names.empty()) return 1;
    return AccessorItems(file, document, attributes.Get(names.front()).GetNumberAsInt()).count();
  }

  std::size_t count() const { return count_; }

  /// Returns the transform from the frame of an instance to the frame of the node.
  Affine<Local, Local> map(std::size_t i) const {
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!t_.empty()) std::copy_n(&t_[3 * i], 3, translation.begin());
    if (!q_.empty()) std::copy_n(&q_[4 * i], 4, rotation.begin());
    if (!s_.empty()) std::copy_n(&s_[3 * i], 3, scale.begin());
    return affine_from_trs<Local, Local>(translation, rotation, scale);
  }

 private:
  std::vector<float> t_, q_, s_;
  std::size_t count_ = 1;
};

/// Returns the classes of a node's instances; empty if the source does not take classes from them.
std::vector<VoxelClass> classes_of(const TileRef& tile, const GltfDocument& document, int node, std::size_t instances,
                                   SourceWarnings& warnings) {
  const std::string where = "nodes[" + std::to_string(node) + "]";
  const tinygltf::Node& of_model = document.model.nodes[std::size_t(node)];
  if (takes_instance_ids(tile.classes.get()) && !document.is_instanced)
    return classes_of_instances(tile.path, document, of_model, where, instances, *tile.classes);
  count_unused_instance_ids(of_model, where, warnings);
  return {};
}

}  // namespace

void for_each_placement(const TileRef& tile, const GltfDocument& document, SourceWarnings& warnings,
                        const std::function<void(const MeshPlacement&)>& visit) {
  const std::filesystem::path& file = tile.path;
  const tinygltf::Model& model = document.model;
  struct Pending {
    int node;
    Map parent;
    std::int32_t lod_of_parent;
  };
  std::vector<Pending> pending;
  const auto push_all = [&pending](const std::vector<int>& nodes, const Map& parent, std::int32_t lod) {
    for (auto n = nodes.rbegin(); n != nodes.rend(); ++n) pending.push_back({*n, parent, lod});
  };
  push_all(root_nodes(model), Map(), not_stated);
  MemoryClaim claim(file);
  std::size_t placed = 0;
  while (!pending.empty()) {
    const Pending at = pending.back();
    pending.pop_back();
    const tinygltf::Node& node = model.nodes[std::size_t(at.node)];
    if (!is_visible(node)) continue;
    const Map map = at.parent * node_map(node);
    if (!map.is_finite())
      throw InputError(file, "nodes[" + std::to_string(at.node) + "]", "the transform is not finite");
    const std::int32_t stated = lod_of_node(tile.named_sizes.get(), node.name),
                       lod = stated == not_stated ? at.lod_of_parent : stated;
    push_all(node.children, map, lod);
    if (node.mesh < 0) continue;
    const NodeInstances instances(file, document, node, claim);
    placed += instances.count();
    if (placed > max_placements) throw InputError(file, "nodes", "more than 2^24 placements of meshes; split the file");
    claim.add_items(instances.count(), placement_bytes, "nodes", "placements of meshes");
    const std::vector<VoxelClass> classes = classes_of(tile, document, at.node, instances.count(), warnings);
    for (std::size_t i = 0; i < instances.count(); ++i)
      visit({node.mesh, map * instances.map(i), lod, classes.empty() ? not_stated : std::int32_t(classes[i])});
  }
}

}  // namespace gigabake
