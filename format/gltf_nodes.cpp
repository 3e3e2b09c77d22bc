#include "format/gltf_nodes.h"

#include <algorithm>

#include "format/error.h"
#include "format/gltf_accessor.h"
#include "format/transform.h"

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

/// Transforms of EXT_mesh_gpu_instancing in the node's own frame.
std::vector<Affine<Local, Local>> instances_of(const std::filesystem::path& file, const tinygltf::Model& model,
                                               const tinygltf::Node& n) {
  const auto extension = n.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == n.extensions.end() || !extension->second.Has("attributes")) return {Affine<Local, Local>()};
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  const auto read = [&](const char* name, int components) {
    return attributes.Has(name) ? read_floats(model, attributes.Get(name).GetNumberAsInt(), components)
                                : std::vector<float>();
  };
  const std::vector<float> t = read("TRANSLATION", 3), q = read("ROTATION", 4), s = read("SCALE", 3);
  const std::size_t count = std::max({t.size() / 3, q.size() / 4, s.size() / 3});
  const auto fits = [count](std::size_t items) { return items == 0 || items == count; };
  if (!fits(t.size() / 3) || !fits(q.size() / 4) || !fits(s.size() / 3))
    throw InputError(file, "EXT_mesh_gpu_instancing", "TRANSLATION, ROTATION and SCALE differ in length");
  std::vector<Affine<Local, Local>> out;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!t.empty()) std::copy_n(&t[3 * i], 3, translation.begin());
    if (!q.empty()) std::copy_n(&q[4 * i], 4, rotation.begin());
    if (!s.empty()) std::copy_n(&s[3 * i], 3, scale.begin());
    out.push_back(affine_from_trs<Local, Local>(translation, rotation, scale));
  }
  return out;
}

}  // namespace

std::vector<MeshPlacement> mesh_placements(const std::filesystem::path& file, const tinygltf::Model& model) {
  struct Pending {
    int node;
    Map parent;
  };
  std::vector<Pending> pending;
  const auto push_all = [&pending](const std::vector<int>& nodes, const Map& parent) {
    for (auto n = nodes.rbegin(); n != nodes.rend(); ++n) pending.push_back({*n, parent});
  };
  push_all(root_nodes(model), Map());
  std::vector<MeshPlacement> out;
  while (!pending.empty()) {
    const Pending at = pending.back();
    pending.pop_back();
    const tinygltf::Node& node = model.nodes[std::size_t(at.node)];
    const Map map = at.parent * node_map(node);
    if (!map.is_finite())
      throw InputError(file, "nodes[" + std::to_string(at.node) + "]", "the transform is not finite");
    if (node.mesh >= 0)
      for (const auto& instance : instances_of(file, model, node)) out.push_back({node.mesh, map * instance});
    push_all(node.children, map);
  }
  return out;
}

}  // namespace gigabake
