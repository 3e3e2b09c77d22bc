#include "format/scene_xml.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <pugixml.hpp>
#include <sstream>

#include "format/channels.h"
#include "format/error.h"
#include "format/publish.h"

namespace gigabake {
namespace {

constexpr int scene_version = 1;

template <class Range, class Text>
std::string joined(const Range& values, const Text& text) {
  std::string out;
  for (const auto& v : values) out += (out.empty() ? "" : " ") + text(v);
  return out;
}

const auto number = [](auto v) { return fmt::format("{}", v); };

void set(pugi::xml_node node, const char* key, const std::string& value) { node.append_attribute(key) = value.c_str(); }

void append_cell(pugi::xml_node group, const SceneDescription& scene, const SceneCell& cell) {
  pugi::xml_node n = group.append_child("PagedOctTree");
  const double edge_m = cell.cell_voxels * scene.voxel_size_m;
  const char* const centre[3] = {"CenterX", "CenterY", "CenterZ"};
  for (int c = 0; c < 3; ++c)
    set(n, centre[c],
        number(scene.lattice_origin_m[std::size_t(c)] + double(cell.lattice_min[std::size_t(c)]) * scene.voxel_size_m +
               edge_m / 2));
  set(n, "Radius", number(edge_m * std::sqrt(3.0) / 2));
  set(n, "TreeFile", cell.file);
  set(n, "Name", cell.name);
  set(n, "LatticeMin", joined(cell.lattice_min, number));
  set(n, "CellVoxels", number(cell.cell_voxels));
  set(n, "Lods", number(cell.lods));
  set(n, "Bytes", number(cell.bytes));
  set(n, "Triangles", number(cell.triangles));
  set(n, "Voxels", joined(cell.voxels, number));
  set(n, "Fingerprint", cell.fingerprint.hex());
  set(n, "ContentHash", joined(cell.content_hash, [](const Hash128& h) { return h.hex(); }));
}

/// One element's attributes, with errors that say which.
class Attributes {
 public:
  Attributes(const std::filesystem::path& file, pugi::xml_node node) : file_(file), node_(node) {}

  std::string text(const char* key) const {
    const pugi::xml_attribute a = node_.attribute(key);
    if (!a) fail(key, "is missing");
    return a.value();
  }
  template <class T>
  T value(const char* key) const {
    const std::vector<T> v = values<T>(key);
    if (v.size() != 1) fail(key, "expected one number");
    return v[0];
  }
  template <class T>
  std::vector<T> values(const char* key) const {
    std::vector<T> out;
    std::istringstream words(text(key));
    for (std::string word; words >> word;) {
      T v{};
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
      if (error != std::errc() || end != word.data() + word.size()) fail(key, "expected numbers, got '" + word + "'");
      if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(v)) fail(key, "expected finite numbers");
      out.push_back(v);
    }
    return out;
  }
  template <class T>
  std::array<T, 3> triple(const char* key) const {
    const std::vector<T> v = values<T>(key);
    if (v.size() != 3) fail(key, "expected three numbers");
    return {v[0], v[1], v[2]};
  }
  std::vector<Hash128> hashes(const char* key) const {
    std::vector<Hash128> out;
    std::istringstream words(text(key));
    for (std::string word; words >> word;) {
      const auto h = Hash128::from_hex(word);
      if (!h) fail(key, "expected 32 hexadecimal digits, got '" + word + "'");
      out.push_back(*h);
    }
    return out;
  }
  bool has(const char* key) const { return bool(node_.attribute(key)); }
  [[noreturn]] void fail(const char* key, const std::string& message) const {
    throw InputError(file_, std::string(node_.name()) + " " + key, message, std::uint64_t(node_.offset_debug()));
  }

 private:
  const std::filesystem::path& file_;
  pugi::xml_node node_;
};

bool stays_inside(const std::filesystem::path& p) {
  if (p.empty() || p.is_absolute()) return false;
  for (const auto& part : p)
    if (part == "..") return false;
  return true;
}

SceneCell read_cell(const Attributes& a) {
  SceneCell c;
  c.name = a.text("Name");
  c.file = a.text("TreeFile");
  if (!stays_inside(c.file)) a.fail("TreeFile", "expected a path inside the scene's folder, got '" + c.file + "'");
  c.lattice_min = a.triple<std::int64_t>("LatticeMin");
  c.cell_voxels = a.value<std::uint32_t>("CellVoxels");
  if (!std::has_single_bit(c.cell_voxels) || c.cell_voxels < 8 || c.cell_voxels > 8192)
    a.fail("CellVoxels", "expected a power of two from 8 to 8192");
  for (const std::int64_t x : c.lattice_min)
    if (x % 8 != 0 || x < -(std::int64_t(1) << 52) || x > std::int64_t(1) << 52)
      a.fail("LatticeMin", "expected multiples of 8 within ±2^52");
  c.lods = a.value<std::uint32_t>("Lods");
  if (c.lods != std::uint32_t(std::bit_width(c.cell_voxels / 8))) a.fail("Lods", "does not fit CellVoxels");
  c.bytes = a.value<std::uint64_t>("Bytes");
  c.triangles = a.value<std::uint64_t>("Triangles");
  c.voxels = a.values<std::uint64_t>("Voxels");
  c.content_hash = a.hashes("ContentHash");
  if (c.voxels.size() != c.lods || c.content_hash.size() != c.lods)
    a.fail("Voxels", "expected one count and one hash a lod");
  const std::vector<Hash128> fingerprint = a.hashes("Fingerprint");
  if (fingerprint.size() != 1) a.fail("Fingerprint", "expected one hash");
  c.fingerprint = fingerprint[0];
  return c;
}

void read_group(const std::filesystem::path& file, pugi::xml_node group, int depth, SceneDescription& scene) {
  if (depth > 64) throw InputError(file, "OctTreeGroup", "groups nest deeper than 64");
  for (const pugi::xml_node child : group.children()) {
    const std::string_view name = child.name();
    const Attributes a(file, child);
    if (name == "OctTreeGroup") read_group(file, child, depth + 1, scene);
    if (name == "PagedOctTree") scene.cells.push_back(read_cell(a));
    if (name == "Loss") scene.losses.push_back({a.text("Name"), a.text("Reason")});
  }
}

void read_header(const Attributes& a, SceneDescription& scene) {
  if (a.value<int>("Version") != scene_version) a.fail("Version", "expected 1; a newer gigabake wrote this scene");
  scene.generator = a.text("Generator");
  scene.voxel_size_m = a.value<double>("VoxelSize");
  if (!(scene.voxel_size_m > 0)) a.fail("VoxelSize", "expected a positive number of metres");
  scene.lattice_origin_m = a.triple<double>("LatticeOrigin");
  if (a.has("Origin")) {
    const auto o = a.triple<double>("Origin");
    scene.origin = Geodetic{o[0], o[1], o[2]};
  }
  if (!parse_channels(a.text("Channels"), scene.has_normals, scene.has_facing))
    a.fail("Channels", "expected 'rgba', then perhaps 'normal' and 'facing'");
  scene.parameters = a.text("Parameters");
  scene.triangles = a.value<std::uint64_t>("Triangles");
  scene.non_finite = a.value<std::uint64_t>("NonFinite");
  scene.zero_area = a.value<std::uint64_t>("ZeroArea");
  scene.skipped_points = a.value<std::uint64_t>("SkippedPoints");
  scene.skipped_lines = a.value<std::uint64_t>("SkippedLines");
}

pugi::xml_node append_group(pugi::xml_document& document, const SceneDescription& scene) {
  pugi::xml_node g = document.append_child("OctTreeGroup");
  set(g, "Version", number(scene_version));
  set(g, "Compressed", "1");
  for (const char* key : {"BrickXSize", "BrickYSize", "BrickZSize"}) set(g, key, number(brick_edge));
  set(g, "Generator", scene.generator);
  set(g, "VoxelSize", number(scene.voxel_size_m));
  set(g, "LatticeOrigin", joined(scene.lattice_origin_m, number));
  if (scene.origin)
    set(g, "Origin",
        fmt::format("{} {} {}", scene.origin->latitude_deg, scene.origin->longitude_deg, scene.origin->height_m));
  set(g, "Channels", channel_names(scene.has_normals, scene.has_facing));
  set(g, "Parameters", scene.parameters);
  set(g, "Triangles", number(scene.triangles));
  set(g, "NonFinite", number(scene.non_finite));
  set(g, "ZeroArea", number(scene.zero_area));
  set(g, "SkippedPoints", number(scene.skipped_points));
  set(g, "SkippedLines", number(scene.skipped_lines));
  return g;
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneDescription& scene) {
  pugi::xml_document document;
  pugi::xml_node group = append_group(document, scene);
  for (const SceneCell& cell : scene.cells) append_cell(group, scene, cell);
  for (const SceneLoss& loss : scene.losses) {
    pugi::xml_node n = group.append_child("Loss");
    set(n, "Name", loss.name);
    set(n, "Reason", loss.reason);
  }
  std::ostringstream text;
  document.save(text, "  ");
  publish_file(path, text.str());
}

SceneDescription read_scene(const std::filesystem::path& path) {
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_file(path.c_str());
  if (!result)
    throw InputError(path, "", std::string("not a scene: ") + result.description(), std::uint64_t(result.offset));
  const pugi::xml_node group = document.child("OctTreeGroup");
  if (!group) throw InputError(path, "OctTreeGroup", "is missing; expected the scene.xml of a bake");
  SceneDescription scene;
  read_header(Attributes(path, group), scene);
  read_group(path, group, 0, scene);
  return scene;
}

}  // namespace gigabake
