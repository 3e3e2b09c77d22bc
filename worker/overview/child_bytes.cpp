#include "worker/overview/child_bytes.h"

#include "core/io/bytes.h"

namespace gigabake {
namespace {

template <class State, class F>
void each_field_of_state(State& s, const F& f) {
  f(s.place), f(s.rgba), f(s.normal), f(s.raster), f(s.patch), f(s.voxel_class);
}

template <class Nodes, class F>
void each_field_of_nodes(Nodes& n, const F& f) {
  f(n.key), f(n.lod), f(n.kind), f(n.child_mask), f(n.first_child), f(n.value), f(n.normal), f(n.directional_coverage),
      f(n.has_finest_planes), f(n.voxel_class);
}

template <class Level, class F>
void each_field_of_level(Level& l, const F& f) {
  f(l.mask), f(l.first), f(l.rgba), f(l.normal), f(l.directional_coverage), f(l.voxel_class);
}

template <class Child, class F>
void each_field_but_levels(Child& c, const F& f) {
  each_field_of_state(c.source, f);
  f(c.copied.lattice_min), f(c.copied.first_lod), f(c.copied.begin);
  each_field_of_nodes(c.copied.coarse.nodes, f);
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const OverviewChild& child) {
  ByteWriter w;
  const auto put = [&w](const auto& field) { w.put(field); };
  each_field_but_levels(child, put);
  put(std::uint64_t(child.copied.coarse.levels.size()));
  for (const BrickLevel& level : child.copied.coarse.levels) each_field_of_level(level, put);
  return w.take();
}

OverviewChild overview_child_from_bytes(std::span<const std::uint8_t> bytes) {
  ByteReader r(bytes, "child of an overview");
  OverviewChild child;
  const auto get = [&r](auto& field) { r.get(field); };
  each_field_but_levels(child, get);
  std::uint64_t levels = 0;
  get(levels);
  for (; levels > 0; --levels)  // terminates because `get` throws at the end of the bytes
    each_field_of_level(child.copied.coarse.levels.emplace_back(), get);
  r.expect_end();
  return child;
}

}  // namespace gigabake
