#include "bench/exact/hard_cases.h"
#include "bench/hard/hard_case.h"

namespace gigabake::bench {
namespace {

struct Rule {
  SurfaceRule rule;
  std::set<reference::Voxel> reference::HardCase::*voxels;
};

const Rule rules[] = {{SurfaceRule::area, &reference::HardCase::area},
                      {SurfaceRule::conservative, &reference::HardCase::conservative},
                      {SurfaceRule::thin, &reference::HardCase::thin}};

}  // namespace

std::vector<HardCase> tie_cases() {
  std::vector<reference::HardCase> table = reference::small_hard_cases();
  for (reference::HardCase& c : reference::wide_hard_cases()) table.push_back(std::move(c));
  std::vector<HardCase> out;
  for (const Rule& rule : rules) {
    const std::string name(name_of(rule.rule));
    for (const reference::HardCase& c : table) {
      HardCase hard = lattice_case(c.name + "." + name, "ties, " + name,
                                   "a tie of docs/accuracy-hard-cases.md; exact clipping, and worked out by hand");
      for (const reference::Triangle& t : c.triangles) add_triangle(hard.scenes[0].tiles[0], t, lattice_unit_m);
      hard.parameters.surface = rule.rule;
      hard.by_hand = c.*rule.voxels;
      out.push_back(std::move(hard));
    }
  }
  return out;
}

}  // namespace gigabake::bench
