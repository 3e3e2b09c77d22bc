#include "worker/parent_bake.h"

#include <algorithm>
#include <utility>

#include "format/shard/shard_reader.h"
#include "kernels/cpu/parent.h"
#include "lattice/error.h"
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
