#include "worker/parent_bake.h"

#include <algorithm>
#include <utility>

#include "format/shard/shard_reader.h"
#include "kernels/cpu/parent.h"
#include "lattice/error.h"
#include "lattice/memory_limit.h"
#include "worker/cell_parameters.h"

namespace gigabake {
namespace {

std::vector<kernels::Level> copies_of(const CellJob& parent, const std::vector<ChildOfParent>& children,
                                      const BakeParameters& p, const ThreadPool& pool) {
  std::vector<const ChildLevels*> copied;
  for (const ChildOfParent& child : children) copied.push_back(&child.copied);
  const CopyWindow window{parent.lattice_min, parent.cell_voxels,
                          parent.first_lod,   parent.first_lod + parent.copied_lods,
                          p.normals,          has_facing(p)};
  return joined_levels(copied, window, pool);
}

}  // namespace

std::string generator() { return "gigabake " GIGABAKE_VERSION; }

ChildOfParent read_child(const ShardReader& reader, const CellJob& parent) {
  ChildOfParent child{reader.above(), {}};
  if (child.source.empty())
    throw InputError(reader.path(), "/above",
                     "is missing, of which the levels above are made: remove the file and bake again");
  child.copied = read_child_levels(reader, parent.first_lod, parent.first_lod + parent.copied_lods);
  return child;
}

std::uint64_t bytes_of(const ChildOfParent& child) {
  const auto all = [](const auto&... columns) {
    return (... + (std::uint64_t(columns.size()) * sizeof(*columns.data())));
  };
  const ParentSource& source = child.source;
  const NodeTable& n = child.copied.nodes;
  std::uint64_t bytes = all(source.place, source.rgba, source.normal, source.raster, source.patch, n.key, n.lod, n.kind,
                            n.child_mask, n.first_child, n.value, n.normal, n.facing);
  for (const BrickLevel& level : child.copied.levels)
    bytes += all(level.mask, level.first, level.rgba, level.normal, level.facing);
  return bytes;
}

std::vector<ChildOfParent> read_children(const std::filesystem::path& out, const CellJob& parent) {
  MemoryClaim memory("parent " + parent.name, "take fewer ranks on the machine");
  std::vector<ChildOfParent> children;
  for (const std::string& file : parent.child_files) {
    const ShardReader reader(out / file);
    // A child that another bake has replaced meanwhile has another file.
    if (shard_file(reader.header().cell, reader.header().fingerprint) != file)
      throw InputError(out / file, "fingerprint", "is not that of its name: remove the file and bake again");
    children.push_back(read_child(reader, parent));
    memory.add_items(2, bytes_of(children.back()), "", "copies of its children's levels");
  }
  return children;
}

kernels::CellVolume make_parent(const CellJob& parent, const std::vector<ChildOfParent>& children,
                                const BakeParameters& parameters, const ThreadPool& pool) {
  std::vector<kernels::ParentChild> sources;
  for (const ChildOfParent& child : children) {
    kernels::ParentChild& source = sources.emplace_back();
    source.source = &child.source;
    std::ranges::copy(child.copied.lattice_min, source.lattice_min);
  }
  return kernels::bake_parent(sources, parent_parameters(parent, parameters), pool,
                              copies_of(parent, children, parameters, pool));
}

}  // namespace gigabake
