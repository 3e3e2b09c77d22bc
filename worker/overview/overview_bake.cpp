#include "worker/overview/overview_bake.h"

#include <mutex>
#include <utility>

#include "core/base/error.h"
#include "core/base/memory_limit.h"
#include "core/base/work_counts.h"
#include "format/shard/shard_reader.h"
#include "kernels/cpu/mip/overview.h"
#include "worker/pipeline/cell_parameters.h"

namespace gigabake {
namespace {

std::vector<kernels::Level> copies_of(const CellJob& overview, const OverviewChildren& children,
                                      const BakeParameters& p, const ThreadPool& pool) {
  std::vector<const ChildLevels*> copied;
  for (const auto& child : children) copied.push_back(&child->copied);
  const DuplicatedWindow window{overview.lattice_min,
                                overview.cell_voxels,
                                overview.first_lod,
                                overview.first_lod + overview.copied_lods,
                                p.normals,
                                has_directional_coverage(p),
                                p.classes};
  return joined_levels(copied, window, pool);
}

}  // namespace

std::string generator() { return "gigabake " GIGABAKE_VERSION; }

OverviewChild read_child(const ShardReader& reader, const CellJob& overview) {
  OverviewChild child{reader.above(), {}};
  if (child.source.empty())
    throw InputError(reader.path(), "/above",
                     "is missing, but overviews are made from it: remove the file and bake again");
  child.copied = read_child_levels(reader, overview.first_lod);
  return child;
}

std::uint64_t bytes_of(const OverviewChild& child) {
  const auto all = [](const auto&... columns) {
    return (... + (std::uint64_t(columns.size()) * sizeof(*columns.data())));
  };
  const DownsampleState& source = child.source;
  const NodeTable& n = child.copied.coarse.nodes;
  std::uint64_t bytes =
      all(source.place, source.rgba, source.normal, source.raster, source.patch, source.voxel_class, n.key, n.lod,
          n.kind, n.child_mask, n.first_child, n.value, n.normal, n.directional_coverage, n.voxel_class);
  for (const BrickLevel& level : child.copied.coarse.levels)
    bytes += all(level.mask, level.first, level.rgba, level.normal, level.directional_coverage, level.voxel_class);
  return bytes;
}

OverviewChild child_of(Shard&& shard, std::uint32_t begin) {
  const ShardHeader& h = shard.header;
  OverviewChild child{std::move(shard.above), {h.lattice_min, h.first_lod, begin, {}}};
  if (begin < h.first_lod + h.lods)
    child.copied.coarse = take_coarse_levels(std::move(shard), int(begin - h.first_lod));
  return child;
}

OverviewChild child_of(const PackedShard& shard, std::uint32_t begin) {
  const ShardHeader& h = shard.header;
  OverviewChild child{shard.above, {h.lattice_min, h.first_lod, begin, {}}};
  if (begin < h.first_lod + h.lods) child.copied.coarse = unpack_coarse_levels(shard, int(begin - h.first_lod));
  return child;
}

namespace {

std::shared_ptr<const OverviewChild> read_child_file(const std::filesystem::path& out, const std::string& file,
                                                     const CellJob& overview) {
  count_work(WorkCounter::overview_children_read);
  const ShardReader reader(out / file);
  // The fingerprint in the header differs from the name if another bake has replaced the child.
  if (shard_file(reader.header().cell, reader.header().fingerprint) != file)
    throw InputError(out / file, "fingerprint", "does not match the file's name: remove the file and bake again");
  return std::make_shared<const OverviewChild>(read_child(reader, overview));
}

}  // namespace

OverviewChildren read_children(const std::filesystem::path& out, const CellJob& overview, const FindChild& find,
                               const ThreadPool& pool) {
  MemoryClaim memory("parent " + overview.name, "use fewer ranks on the machine");
  std::mutex claiming;
  OverviewChildren children(overview.child_files.size());
  pool.parallel_for(children.size(), 1, [&](std::size_t c, std::size_t, int) {
    const std::string& file = overview.child_files[c];
    children[c] = find(file);
    if (!children[c] || children[c]->copied.begin != overview.first_lod)
      children[c] = read_child_file(out, file, overview);
    count_work(WorkCounter::overview_children);
    count_work(WorkCounter::overview_rows, children[c]->copied.coarse.nodes.key.size());
    const std::scoped_lock lock(claiming);
    memory.add_items(2, bytes_of(*children[c]), "", "duplicated levels of its children");
  });
  return children;
}

kernels::CellVolume make_overview(const CellJob& overview, const OverviewChildren& children,
                                  const BakeParameters& parameters, const ThreadPool& pool) {
  std::vector<kernels::JoinedChild> sources;
  for (const auto& child : children) {
    kernels::JoinedChild& source = sources.emplace_back();
    source.source = &child->source;
    source.lattice_min = child->copied.lattice_min;
  }
  return kernels::bake_overview(sources, overview_parameters(overview, parameters), pool,
                                copies_of(overview, children, parameters, pool));
}

}  // namespace gigabake
