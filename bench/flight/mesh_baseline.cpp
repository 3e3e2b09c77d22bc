#include "bench/flight/mesh_baseline.h"

#include "core/base/thread_pool.h"

namespace gigabake::bench {
namespace {

std::uint64_t vertices_of(const std::vector<std::uint32_t>& index, std::size_t vertices) {
  std::vector<bool> is_used(vertices, false);
  std::uint64_t used = 0;
  for (const std::uint32_t vertex : index) {
    used += is_used[vertex] ? 0 : 1;
    is_used[vertex] = true;
  }
  return used;
}

std::uint64_t bytes_of(const kernels::PartView& part, const std::vector<std::uint32_t>& index) {
  const std::uint64_t per_vertex = 12 + (part.uv.empty() ? 0 : 8) + (part.rgba.empty() ? 0 : 4);
  return 4 * index.size() + per_vertex * vertices_of(index, part.position.size / 3);
}

}  // namespace

MeshBaseline::MeshBaseline(const SourceTriangles& source, int threads) : source_(source), parts_(source.parts()) {
  ThreadPool(threads).parallel_for(parts_.size(), 1, [&](std::size_t begin, std::size_t end, int) {
    for (std::size_t part = begin; part < end; ++part) parts_[part] = make_mesh_levels(source, part);
  });
}

MeshChoice MeshBaseline::choose(const kernels::CastCamera& camera, double max_pixels) const {
  MeshChoice choice;
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    choice.indices.push_back({});
    const std::optional<std::size_t> level = choose_level(parts_[part], camera, max_pixels);
    if (!level) continue;
    const std::vector<std::uint32_t>& index = parts_[part].levels[*level].index;
    choice.indices.back() = {index.data(), index.size()};
    choice.triangles += index.size() / 3;
    choice.bytes += bytes_of(source_.part(part), index);
  }
  return choice;
}

std::uint64_t MeshBaseline::source_triangles() const {
  std::uint64_t triangles = 0;
  for (const MeshLevels& part : parts_) triangles += part.levels.front().index.size() / 3;
  return triangles;
}

}  // namespace gigabake::bench
