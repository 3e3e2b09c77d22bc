#include "format/scene/xml/scene_reading.h"

#include <cmath>
#include <fmt/format.h>
#include <iterator>

#include "format/scene/check/scene_check.h"
#include "format/scene/paged_scene.h"
#include "format/scene/tier_shape.h"
#include "format/scene/xml/scene_attributes.h"
#include "format/scene/xml/scene_elements.h"
#include "format/scene/xml/scene_text.h"
#include "format/system/host_limits.h"

namespace gigabake {
namespace {

constexpr std::uint64_t max_scene_bytes = std::uint64_t(64) << 30;

/// Returns the attributes that the outermost group and nested groups may have.
std::span<const std::string_view> known_of_scene(int version) {
  static const std::vector<std::string_view> of_all = {
      "Version",       "Compressed",   "BrickXSize", "BrickYSize", "BrickZSize", "Generator",  "VoxelSize",
      "LatticeOrigin", "Origin",       "Channels",   "Parameters", "Triangles",  "NonFinite",  "ZeroArea",
      "SkippedPoints", "SkippedLines", "Checksum",   "Cells",      "Voxels",     "ContentHash"};
  static const std::vector<std::string_view> of_3 = [] { return with_totals({of_all.begin(), of_all.end() - 3}); }();
  static const std::vector<std::string_view> of_5 = [] {
    std::vector<std::string_view> names = of_3;
    names.insert(names.end(), {"ParentTiers", "BoundsMin", "BoundsEnd"});
    return names;
  }();
  static const std::vector<std::string_view> of_6 = [] {
    std::vector<std::string_view> names = of_5;
    names.emplace_back("LeafLod");
    return names;
  }();
  if (version >= 6) return of_6;
  if (version == 5) return of_5;
  if (version >= 3) return of_3;
  return std::span(of_all).first(version == 2 ? of_all.size() : of_all.size() - 4);
}

/// A reader of one document that collects its faults.
class SceneReader {
 public:
  SceneReader(const std::filesystem::path& file, SceneReading& reading) : file_(file), reading_(reading) {}

  void read(const pugi::xml_document& document) {
    const pugi::xml_node group = root_of(file_, document, reading_.faults);
    const SceneAttributes a(file_, group);
    reading_.version = a.value<int>("Version");
    if (reading_.version < 1 || reading_.version > newest_scene_version)
      a.fail("Version", fmt::format("expected 1 to {}; a newer gigabake wrote this scene", newest_scene_version));
    read_header(a);
    read_counts(a);
    if (reading_.version >= 2) read_said(a);
    faults(faults_of_root(a, known_of_scene(reading_.version)));
    GroupContent content =
        read_content(file_, group, reading_.scene, reading_.version, known_of_scene(reading_.version));
    faults(std::move(content.faults));
    reading_.scene.cells = std::move(content.cells);
    reading_.scene.overviews = std::move(content.overviews);
    reading_.scene.losses = std::move(content.losses);
    reading_.pages = std::move(content.pages);
  }

 private:
  void faults(std::vector<SceneFault> all) { std::move(all.begin(), all.end(), std::back_inserter(reading_.faults)); }

  void read_header(const SceneAttributes& a) {
    SceneDescription& scene = reading_.scene;
    scene.generator = a.text("Generator");
    if (scene.generator.empty()) reading_.faults.push_back(a.fault("Generator", "is empty"));
    read_lattice(a, scene);
    if (a.has("Origin")) {
      const auto o = a.triple<double>("Origin");
      scene.origin = Geodetic{o[0], o[1], o[2]};
      if (std::fabs(o[0]) > 90 || std::fabs(o[1]) > 360)
        a.fail("Origin", "expected a latitude within ±90 and a longitude within ±360 degrees");
    }
    scene.parameters = a.text("Parameters");
    if (scene.has_classes != (reading_.version >= first_scene_version_of_classes))
      a.fail("Channels", scene.has_classes ? "state 'class', which this version does not have" : "lack 'class'");
    if (reading_.version < first_scene_version_of_leaves) return;
    if (reading_.version >= first_scene_version_of_classes && !a.has("LeafLod")) return;
    scene.leaf_lod = a.value<std::uint32_t>("LeafLod");
    if (scene.leaf_lod < 1 || scene.leaf_lod > 10) a.fail("LeafLod", "expected 1 to 10");
  }

  void read_counts(const SceneAttributes& a) {
    SceneDescription& scene = reading_.scene;
    scene.triangles = a.value<std::uint64_t>("Triangles");
    scene.non_finite = a.value<std::uint64_t>("NonFinite");
    scene.zero_area = a.value<std::uint64_t>("ZeroArea");
    scene.skipped_points = a.value<std::uint64_t>("SkippedPoints");
    scene.skipped_lines = a.value<std::uint64_t>("SkippedLines");
  }

  void read_said(const SceneAttributes& a) {
    a.hash("Checksum");
    reading_.said =
        StoredTotals{a.value<std::uint64_t>("Cells"), a.values<std::uint64_t>("Voxels"), a.hash("ContentHash")};
    if (reading_.version < 3) return;
    reading_.said->overviews = a.value<std::uint64_t>("Parents");
    reading_.totals = read_totals(a, reading_.version);
    reading_.totals->overviews = reading_.said->overviews;
    if (reading_.version < 5) return;
    if (a.has("ParentTiers")) read_tiers(a);
    if (a.has("BoundsMin") || a.has("BoundsEnd")) read_bounds(a);
  }

  void read_bounds(const SceneAttributes& a) {
    reading_.scene.bounds = read_box(a, "BoundsMin", "BoundsEnd");
    if (reading_.totals->cells != 0 && !reading_.scene.bounds.overlaps(reading_.totals->window))
      a.fail("BoundsMin", "expected a box that overlaps the box from LatticeMin to LatticeEnd");
  }

  void read_tiers(const SceneAttributes& a) {
    const auto numbers = a.values<std::uint32_t>("ParentTiers");
    if (numbers.empty() || numbers.size() % 3 != 0) a.fail("ParentTiers", "expected three numbers per overview level");
    for (std::size_t t = 0; t < numbers.size(); t += 3)
      reading_.scene.tiers.push_back({numbers[t], numbers[t + 1], numbers[t + 2]});
    if (const auto fault = fault_of_tiers(reading_.scene.tiers, reading_.totals->cell_voxels))
      a.fail("ParentTiers", *fault);
  }

  const std::filesystem::path& file_;
  SceneReading& reading_;
};

}  // namespace

InputError error_of(const std::filesystem::path& file, const SceneFault& fault) {
  return {file, fault.key, fault.message, fault.byte_offset};
}

SceneReading read_scene_text(const std::filesystem::path& path) {
  const SceneText text(path, max_scene_bytes);
  SceneReading reading;
  SceneReader(path, reading).read(text.document());
  if (reading.version >= 2 && !text.checksum().is_said)
    reading.faults.push_back(
        {"OctTreeGroup Checksum", "does not match this text, which was changed after it was written; bake again", {}});
  return reading;
}

SceneDescription read_scene(const std::filesystem::path& path) {
  const PagedScene scene(path);
  return scene.root().pages.empty() ? scene.all() : scene.all(ThreadPool(host_limits().cores()));
}

}  // namespace gigabake
