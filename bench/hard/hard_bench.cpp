#include "bench/hard/hard_bench.h"

#include <algorithm>
#include <numbers>

#include "bench/hard/exact_place.h"
#include "bench/hard/hard_bake.h"
#include "bench/hard/surfaces/surface_bench.h"
#include "core/base/error.h"

namespace gigabake::bench {
namespace {

/// The minima below which colour and normal are not compared: a faint colour and a short mean normal are undefined.
constexpr double min_visible_fraction = 0.02, min_certainty = 0.01;

struct VoxelErrors {
  std::uint64_t missed = 0, extra = 0;
  double alpha_codes = 0, colour_codes = 0, colour_linear = 0, normal_deg = 0;
};

void add_voxel(const StoredVoxel& stored, const reference::ExpectedVoxel& expected, VoxelErrors& errors) {
  using namespace reference;
  const auto grow = [](double& worst, double error) { worst = std::max(worst, error); };
  grow(errors.alpha_codes, std::abs(stored.rgba[3] - 255 * expected.alpha()));
  const double visible_fraction = expected.visible_fraction();
  if (visible_fraction < min_visible_fraction) return;
  for (int c = 0; c < 3; ++c) {
    // Premultiplied colours are rounded to 16 bits. The error is at most 0.1 codes of 255 for a dark opaque colour, and
    // inversely proportional to the visible fraction of the area.
    const double lost = 0.1 / visible_fraction - 0.1;
    grow(errors.colour_codes, code_error(stored.rgba[std::size_t(c)], expected.linear(c)) - lost);
    grow(errors.colour_linear, std::abs(linear_of(stored.rgba[std::size_t(c)] / 255.0) - expected.linear(c)));
  }
  if (expected.certainty() > min_certainty)
    grow(errors.normal_deg, expected.normal_error_deg(direction_of(stored.normal)));
}

/// Compares stored with expected voxels. A voxel may be missing or extra if its alpha is below the bound of alpha.
void compare(const StoredVoxels& stored, const ExpectedVoxels& expected, const HardBounds& bounds,
             VoxelErrors& errors) {
  constexpr double rounding = 0.501;
  const double slack = std::max(0.0, bounds.alpha_codes - rounding);
  for (const auto& [voxel, what] : expected) {
    const auto found = stored.find(voxel);
    if (found != stored.end()) {
      add_voxel(found->second, what, errors);
      continue;
    }
    errors.alpha_codes = std::max(errors.alpha_codes, 255 * what.alpha());
    if (255 * what.alpha() >= 0.5 + slack) ++errors.missed;
  }
  for (const auto& [voxel, value] : stored) {
    const auto found = expected.find(voxel);
    if (found != expected.end() && 255 * found->second.alpha() >= 0.5) continue;
    if (found == expected.end()) errors.alpha_codes = std::max(errors.alpha_codes, double(value.rgba[3]));
    if (value.rgba[3] > slack) ++errors.extra;
  }
}

/// Compares the voxels of level 0 and the leaves of each coarser level.
VoxelErrors compare(const HardBake& bake, const std::vector<ExpectedVoxels>& expected, const HardBounds& bounds) {
  VoxelErrors errors;
  compare(bake.voxels, expected.at(0), bounds, errors);
  const ExpectedVoxels none;
  for (std::size_t l = 0; l < bake.leaves.size(); ++l)
    compare(bake.leaves[l], l + 1 < expected.size() ? expected[l + 1] : none, bounds, errors);
  return errors;
}

/// Returns the expected voxels of level 0, and of the leaves of each coarser level.
std::vector<ExpectedVoxels> expected_of(const HardCase& hard, const SceneSources& sources) {
  if (hard.expected_levels) return hard.expected_levels();
  if (hard.expected) return {hard.expected()};
  return {reference::expected_voxels(painted_triangles(hard.scenes[0], sources.origin, hard.parameters),
                                     hard.parameters.surface, hard.window)};
}

void add_hand_work(const HardCase& hard, const StoredVoxels& stored, HardResult& out) {
  if (!hard.by_hand) return;
  std::size_t met = 0;
  for (const reference::Voxel& v : *hard.by_hand) met += stored.count(v);
  out.figures.push_back(
      {"differs from hand-work", "voxels", double(hard.by_hand->size() + stored.size() - 2 * met), 0});
}

void add_figures(const HardCase& hard, const HardBake& bake, const std::vector<ExpectedVoxels>& expected,
                 HardResult& out) {
  const VoxelErrors e = compare(bake, expected, hard.bounds);
  const HardBounds& b = hard.bounds;
  const double snap_m = std::numbers::sqrt3 * hard.parameters.voxel_size_m / 512;
  out.voxels = bake.voxels.size();
  for (const StoredVoxels& leaves : bake.leaves) out.voxels += leaves.size();
  out.figures = {{"missed", "voxels", double(e.missed), 0},
                 {"extra", "voxels", double(e.extra), 0},
                 {"alpha", "codes", e.alpha_codes, b.alpha_codes}};
  if (b.colour_codes) out.figures.push_back({"colour", "codes", e.colour_codes, *b.colour_codes});
  if (b.colour_linear) out.figures.push_back({"linear colour", "", e.colour_linear, *b.colour_linear});
  if (b.normal_deg) out.figures.push_back({"normal", "°", e.normal_deg, *b.normal_deg});
  out.figures.push_back({"position", "m", bake.position_m, snap_m + b.placement_m});
  out.figures.push_back({"before the snap", "m", bake.placement_m, b.placement_m});
  add_hand_work(hard, bake.voxels, out);
  if (hard.more)
    for (HardFigure& f : hard.more(bake)) out.figures.push_back(std::move(f));
}

/// Compares the bakes of the case's other scenes with the first bake. All bakes must be bit-identical.
void add_variants(const HardCase& hard, const std::filesystem::path& folder, const HardMachine& machine,
                  const HardBake& first, HardResult& out) {
  if (hard.scenes.size() < 2) return;
  double differing = 0;
  for (std::size_t i = 1; i < hard.scenes.size(); ++i) {
    const std::filesystem::path variant = folder / ("written-otherwise-" + std::to_string(i));
    const SceneSources sources = open_hard(variant, hard.scenes[i]);
    differing += bake_hard(variant, hard.scenes[i], hard, machine, sources).content_hash != first.content_hash;
  }
  out.figures.push_back(
      {"differ in a bit", "of " + std::to_string(hard.scenes.size() - 1) + " ways to write it", differing, 0});
}

/// Returns the name with "/" replaced, because "1/4" is no folder name.
std::string file_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '-');
  return name;
}

std::vector<HardCase> all_cases(int million_triangles) {
  std::vector<HardCase> all;
  for (auto& group : {tie_cases(), value_cases(), extreme_cases(million_triangles), earth_cases(), texture_cases(),
                      leaf_cases(), class_cases()})
    all.insert(all.end(), group.begin(), group.end());
  return all;
}

}  // namespace

HardResult run_hard_case(const HardCase& hard, const std::filesystem::path& folder, const HardMachine& machine) {
  HardResult out{hard.name, hard.group, hard.what, 0, {}, {}};
  try {
    const SceneSources sources = open_hard(folder, hard.scenes.at(0));
    const HardBake bake = bake_hard(folder, hard.scenes[0], hard, machine, sources);
    if (!bake.report.note.empty()) out.error = bake.report.note;
    add_figures(hard, bake, expected_of(hard, sources), out);
    add_variants(hard, folder, machine, bake, out);
  } catch (const InputError& e) {
    out.error = e.what();
  }
  return out;
}

HardCase lattice_case(std::string name, std::string group, std::string what) {
  HardCase hard;
  hard.name = std::move(name);
  hard.group = std::move(group);
  hard.what = std::move(what);
  hard.scenes.resize(1);
  hard.scenes[0].tiles.resize(1);
  hard.parameters.voxel_size_m = 256 * lattice_unit_m;
  hard.window = {{-8, -8, -8}, 16};
  return hard;
}

bool HardResult::holds() const {
  return error.empty() && std::all_of(figures.begin(), figures.end(), [](const HardFigure& f) { return f.holds(); });
}

bool HardBench::holds() const {
  return std::all_of(cases.begin(), cases.end(), [](const HardResult& r) { return r.holds(); });
}

namespace {

LeakBench few_leaks(const HardBenchRequest& hard) {
  LeakBenchRequest request;
  request.out = hard.out / "leaks";
  request.keep = true;
  request.backend = hard.backend;
  request.threads = hard.threads;
  request.suite = LeakSuite::few_planes;
  request.edge = 400;
  return bench_leaks(request, [](const std::string&) {});
}

}  // namespace

HardBench bench_hard(const HardBenchRequest& request, const std::function<void(const HardResult&)>& done) {
  const HardMachine machine{choose_device({request.backend}).device, request.threads};
  HardBench out{machine.cuda_device ? "cuda" : "cpu", {}, {}};
  for (const HardCase& hard : all_cases(request.million_triangles)) {
    out.cases.push_back(run_hard_case(hard, request.out / file_name(hard.name), machine));
    done(out.cases.back());
  }
  run_surface_cases(request.out, machine, [&](HardResult&& result) {
    out.cases.push_back(std::move(result));
    done(out.cases.back());
  });
  out.leaks = few_leaks(request);
  return out;
}

}  // namespace gigabake::bench
