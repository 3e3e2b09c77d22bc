#include "format/scene/scene_reading.h"

#define XXH_INLINE_ALL
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <pugixml.hpp>
#include <xxhash.h>

#include "format/scene/scene_attributes.h"
#include "format/scene/scene_check.h"
#include "format/shard/channels.h"
#include "format/system/read_file.h"

namespace gigabake {
namespace {

constexpr std::uint64_t most_scene_bytes = std::uint64_t(64) << 30;
constexpr std::string_view checksum_begin = " Checksum=\"", checksum_zeros = "00000000000000000000000000000000";
constexpr std::size_t no_digits = std::string::npos;

/// Where the 32 digits begin.
std::size_t find_checksum(std::string_view text) {
  const std::size_t at = text.find(checksum_begin);
  const std::size_t digits = at + checksum_begin.size(), end = digits + checksum_zeros.size();
  return at == std::string_view::npos || end >= text.size() || text[end] != '"' ? no_digits : digits;
}

/// Of the text with zeros for its digits, which stand at `at`.
Hash128 checksum_of(std::string_view text, std::size_t at) {
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  for (const std::string_view part : {text.substr(0, at), checksum_zeros, text.substr(at + checksum_zeros.size())})
    XXH3_128bits_update(&state, part.data(), part.size());
  const XXH128_hash_t h = XXH3_128bits_digest(&state);
  return {h.low64, h.high64};
}

bool has_its_checksum(std::string_view text) {
  const std::size_t at = find_checksum(text);
  return at != no_digits && text.substr(at, checksum_zeros.size()) == checksum_of(text, at).hex();
}

std::optional<double> parsed_number(const std::string& text) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(v) : std::nullopt;
}

/// Of names that messages quote: those of a bake have at most 98 bytes.
bool is_short_line(std::string_view text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  return !text.empty() && text.size() <= 128 && std::none_of(text.begin(), text.end(), is_control);
}

bool stays_inside(const std::filesystem::path& p) {
  if (p.empty() || p.is_absolute()) return false;
  for (const auto& part : p)
    if (part == "..") return false;
  return true;
}

/// The window and the levels of a cell.
void read_place(const SceneAttributes& a, SceneCell& c) {
  c.lattice_min = a.triple<std::int64_t>("LatticeMin");
  c.cell_voxels = a.value<std::uint32_t>("CellVoxels");
  if (a.has("FirstLod")) c.first_lod = a.value<std::uint32_t>("FirstLod");
  if (a.has("FirstLod") && (c.first_lod < 1 || c.first_lod > 28)) a.fail("FirstLod", "expected 1 to 28");
  const std::uint32_t edge = c.cell_voxels >> c.first_lod;
  if (!std::has_single_bit(c.cell_voxels) || edge < 8 || edge > 8192)
    a.fail("CellVoxels", "expected a power of two from 8 to 8192 voxels of the finest level");
  for (const std::int64_t x : c.lattice_min)
    if (x % 8 != 0 || x < -(std::int64_t(1) << 52) || x > std::int64_t(1) << 52)
      a.fail("LatticeMin", "expected multiples of 8 within ±2^52");
  c.lods = a.value<std::uint32_t>("Lods");
  if (c.lods != std::uint32_t(std::bit_width(edge / 8))) a.fail("Lods", "does not fit CellVoxels");
}

SceneCell read_cell(const SceneAttributes& a) {
  SceneCell c;
  c.name = a.text("Name");
  if (!is_short_line(c.name)) a.fail("Name", "expected one line of 1 to 128 bytes, got " + in_quotes(c.name));
  c.file = a.text("TreeFile");
  if (!is_short_line(c.file)) a.fail("TreeFile", "expected one line of 1 to 128 bytes, got " + in_quotes(c.file));
  if (!stays_inside(c.file)) a.fail("TreeFile", "expected a path inside the scene's folder, got " + in_quotes(c.file));
  read_place(a, c);
  c.bytes = a.value<std::uint64_t>("Bytes");
  c.triangles = a.value<std::uint64_t>("Triangles");
  c.voxels = a.values<std::uint64_t>("Voxels");
  c.content_hash = a.hashes("ContentHash");
  if (c.voxels.size() != c.lods || c.content_hash.size() != c.lods)
    a.fail("Voxels", "expected one count and one hash a lod");
  c.fingerprint = a.hash("Fingerprint");
  return c;
}

/// Reads one document, and collects what is wrong with it besides.
class SceneReader {
 public:
  SceneReader(const std::filesystem::path& file, SceneReading& reading) : file_(file), reading_(reading) {}

  void read(const pugi::xml_document& document) {
    const pugi::xml_node group = document.child("OctTreeGroup");
    if (!group) throw InputError(file_, "OctTreeGroup", "is missing; expected the scene.xml of a bake");
    for (const pugi::xml_node other : document.children())
      if (other.type() == pugi::node_element && other != group)
        fault(SceneAttributes(file_, other).fault("", "is a second root; expected one OctTreeGroup"));
    const SceneAttributes a(file_, group);
    reading_.version = a.value<int>("Version");
    if (reading_.version < 1 || reading_.version > newest_scene_version)
      a.fail("Version", fmt::format("expected 1 to {}; a newer gigabake wrote this scene", newest_scene_version));
    read_header(a);
    read_counts(a);
    if (reading_.version >= 2) read_totals(a);
    check_thesis_attributes(a);
    read_group(group, 0);
  }

 private:
  void fault(SceneFault f) { reading_.faults.push_back(std::move(f)); }
  void faults(std::vector<SceneFault> all) {
    for (SceneFault& f : all) fault(std::move(f));
  }

  void read_header(const SceneAttributes& a) {
    SceneDescription& scene = reading_.scene;
    scene.generator = a.text("Generator");
    if (scene.generator.empty()) fault(a.fault("Generator", "is empty"));
    scene.voxel_size_m = a.value<double>("VoxelSize");
    if (!(scene.voxel_size_m > 0)) a.fail("VoxelSize", "expected a positive number of metres");
    scene.lattice_origin_m = a.triple<double>("LatticeOrigin");
    if (a.has("Origin")) {
      const auto o = a.triple<double>("Origin");
      scene.origin = Geodetic{o[0], o[1], o[2]};
      if (std::fabs(o[0]) > 90 || std::fabs(o[1]) > 360)
        a.fail("Origin", "expected a latitude within ±90 and a longitude within ±360 degrees");
    }
    if (!parse_channels(a.text("Channels"), scene.has_normals, scene.has_facing))
      a.fail("Channels", "expected 'rgba', then perhaps 'normal' and 'facing'");
    scene.parameters = a.text("Parameters");
  }

  void read_counts(const SceneAttributes& a) {
    SceneDescription& scene = reading_.scene;
    scene.triangles = a.value<std::uint64_t>("Triangles");
    scene.non_finite = a.value<std::uint64_t>("NonFinite");
    scene.zero_area = a.value<std::uint64_t>("ZeroArea");
    scene.skipped_points = a.value<std::uint64_t>("SkippedPoints");
    scene.skipped_lines = a.value<std::uint64_t>("SkippedLines");
  }

  void read_totals(const SceneAttributes& a) {
    a.hash("Checksum");
    reading_.said = SaidTotals{a.value<std::uint64_t>("Cells"), a.values<std::uint64_t>("Voxels"),
                               a.hash("ContentHash"), reading_.version >= 3 ? a.value<std::uint64_t>("Parents") : 0};
  }

  /// What readers of the thesis's schema look at, and ours do not.
  void check_thesis_attributes(const SceneAttributes& a) {
    if (!a.has("Compressed") || a.text("Compressed") != "1") fault(a.fault("Compressed", "expected 1"));
    for (const char* key : {"BrickXSize", "BrickYSize", "BrickZSize"})
      if (!a.has(key) || a.text(key) != "8") fault(a.fault(key, "expected 8"));
  }

  /// The sphere around a cell follows from its window.
  void check_sphere(const SceneAttributes& a, const SceneCell& cell) {
    const SceneDescription& scene = reading_.scene;
    const double edge_m = cell.cell_voxels * scene.voxel_size_m;
    const char* const centre[3] = {"CenterX", "CenterY", "CenterZ"};
    for (std::size_t c = 0; c < 3; ++c) {
      const double low_m = double(cell.lattice_min[c]) * scene.voxel_size_m;
      const double size = std::fabs(scene.lattice_origin_m[c]) + std::fabs(low_m) + edge_m;
      check_number(a, centre[c], scene.lattice_origin_m[c] + low_m + edge_m / 2, size);
    }
    check_number(a, "Radius", edge_m * std::sqrt(3.0) / 2, edge_m);
  }

  /// size: of the numbers that it was made of; what is lost in them may differ.
  void check_number(const SceneAttributes& a, const char* key, double expected, double size) {
    const auto said = a.has(key) ? parsed_number(a.text(key)) : std::nullopt;
    if (!said || !(std::fabs(*said - expected) <= 1e-12 * size))
      fault(a.fault(key, fmt::format("expected {}, which follows from LatticeMin and CellVoxels", expected)));
  }

  void read_group(pugi::xml_node group, int depth) {
    if (depth > 64) throw InputError(file_, "OctTreeGroup", "groups nest deeper than 64");
    check_group_parts(group);
    for (const pugi::xml_node child : group.children()) {
      const std::string_view name = child.name();
      const SceneAttributes a(file_, child);
      if (name == "OctTreeGroup") read_group(child, depth + 1);
      if (name == "PagedOctTree") read_cell_of(a);
      if (name == "Loss") {
        reading_.scene.losses.push_back({a.text("Name"), a.text("Reason")});
        faults(a.unknown_parts({"Name", "Reason"}, {}));
      }
    }
  }

  void read_cell_of(const SceneAttributes& a) {
    SceneCell cell = read_cell(a);
    check_sphere(a, cell);
    (cell.first_lod == 0 ? reading_.scene.cells : reading_.scene.parents).push_back(std::move(cell));
    faults(a.unknown_parts({"CenterX", "CenterY", "CenterZ", "Radius", "TreeFile", "Name", "LatticeMin", "CellVoxels",
                            "FirstLod", "Lods", "Bytes", "Triangles", "Voxels", "Fingerprint", "ContentHash"},
                           {}));
  }

  void check_group_parts(pugi::xml_node group) {
    const SceneAttributes a(file_, group);
    const auto check = [&](auto... of_version_2) {
      faults(a.unknown_parts({"Version", "Compressed", "BrickXSize", "BrickYSize", "BrickZSize", "Generator",
                              "VoxelSize", "LatticeOrigin", "Origin", "Channels", "Parameters", "Triangles",
                              "NonFinite", "ZeroArea", "SkippedPoints", "SkippedLines", of_version_2...},
                             {"OctTreeGroup", "PagedOctTree", "Loss"}));
    };
    if (reading_.version >= 3)
      check("Cells", "Parents", "Voxels", "ContentHash", "Checksum");
    else if (reading_.version >= 2)
      check("Cells", "Voxels", "ContentHash", "Checksum");
    else
      check();
  }

  const std::filesystem::path& file_;
  SceneReading& reading_;
};

}  // namespace

std::string with_checksum(std::string text) {
  const std::size_t at = find_checksum(text);
  return at == no_digits ? text : text.replace(at, checksum_zeros.size(), checksum_of(text, at).hex());
}

InputError error_of(const std::filesystem::path& file, const SceneFault& fault) {
  return {file, fault.key, fault.message, fault.byte_offset};
}

SceneReading read_scene_text(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_whole_file(path, most_scene_bytes);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(bytes.data(), bytes.size());
  if (!result)
    throw InputError(path, "", std::string("not a scene: ") + result.description(), std::uint64_t(result.offset));
  SceneReading reading;
  SceneReader(path, reading).read(document);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (reading.version >= 2 && !has_its_checksum(text))
    reading.faults.push_back(
        {"OctTreeGroup Checksum", "is not that of this text, which was changed after it was written; bake again", {}});
  return reading;
}

SceneDescription read_scene(const std::filesystem::path& path) {
  SceneReading reading = read_scene_text(path);
  const std::vector<SceneFault> faults = faults_of_cells(reading);
  if (!faults.empty()) throw error_of(path, faults[0]);
  return std::move(reading.scene);
}

}  // namespace gigabake
