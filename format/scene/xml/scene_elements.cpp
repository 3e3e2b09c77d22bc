#include "format/scene/xml/scene_elements.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <set>

#include "format/shard/columns/channels.h"

namespace gigabake {
namespace {

constexpr std::int64_t max_voxel = std::int64_t(1) << 52, max_end = 2 * max_voxel;

std::optional<double> parsed_number(const std::string& text) {
  double v = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(v) : std::nullopt;
}

/// Returns whether a name is one short line, so that messages can quote it. Names written by a bake have at most 128
/// bytes.
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

std::string read_file_name(const SceneAttributes& a, const char* key) {
  std::string file = a.text(key);
  if (!is_short_line(file)) a.fail(key, "expected one line of 1 to 128 bytes, got " + in_quotes(file));
  if (!stays_inside(file)) a.fail(key, "expected a path inside the scene's folder, got " + in_quotes(file));
  return file;
}

/// Reads the window and the levels of a cell or an overview.
void read_place(const SceneAttributes& a, SceneCell& c, int version) {
  c.lattice_min = a.triple<std::int64_t>("LatticeMin");
  c.cell_voxels = a.value<std::uint32_t>("CellVoxels");
  const bool is_overview = a.has("FirstLod");
  if (is_overview) c.first_lod = a.value<std::uint32_t>("FirstLod");
  if (is_overview && (c.first_lod < 1 || c.first_lod > 28)) a.fail("FirstLod", "expected 1 to 28");
  const std::uint32_t edge = c.cell_voxels >> c.first_lod;
  if (!std::has_single_bit(c.cell_voxels) || edge < 8 || edge > 8192)
    a.fail("CellVoxels", "expected a power of two from 8 to 8192 voxels of the finest level");
  for (const std::int64_t x : c.lattice_min)
    if (x % 8 != 0 || x < -max_voxel || x > max_voxel) a.fail("LatticeMin", "expected multiples of 8 within ±2^52");
  c.lods = a.value<std::uint32_t>("Lods");
  if (c.lods != std::uint32_t(std::bit_width(edge / 8))) a.fail("Lods", "does not match CellVoxels");
  if (is_overview && version >= 4) c.copied_lods = a.value<std::uint32_t>("CopiedLods");
  if (c.copied_lods >= c.lods) a.fail("CopiedLods", "expected fewer than Lods");
}

SceneCell read_cell(const SceneAttributes& a, int version) {
  SceneCell c;
  c.name = a.text("Name");
  if (!is_short_line(c.name)) a.fail("Name", "expected one line of 1 to 128 bytes, got " + in_quotes(c.name));
  c.file = read_file_name(a, "TreeFile");
  read_place(a, c, version);
  c.bytes = a.value<std::uint64_t>("Bytes");
  c.triangles = a.value<std::uint64_t>("Triangles");
  c.voxels = a.values<std::uint64_t>("Voxels");
  c.content_hash = a.hashes("ContentHash");
  if (c.voxels.size() != c.lods || c.content_hash.size() != c.lods)
    a.fail("Voxels", "expected one count and one hash per lod");
  c.fingerprint = a.hash("Fingerprint");
  if (version < 3 || !(a.has("LevelBytes") || a.has("NodeBytes"))) return c;
  c.level_bytes = a.values<std::uint64_t>("LevelBytes");
  c.node_bytes = a.value<std::uint64_t>("NodeBytes");
  if (c.level_bytes.size() != c.lods) a.fail("LevelBytes", "expected one number per lod");
  return c;
}

PageReference read_reference(const SceneAttributes& a, int version) {
  PageReference r;
  r.file = read_file_name(a, "GroupFile");
  r.checksum = a.hash("GroupChecksum");
  r.block = read_block(a);
  r.groups = a.value<std::uint64_t>("Groups");
  r.totals = read_totals(a, version);
  if (r.totals.cells == 0 || r.totals.cell_voxels == 0) a.fail("CellVoxels", "expected a page of cells of one size");
  return r;
}

/// A reader of the elements of one document.
class ContentReader {
 public:
  ContentReader(const std::filesystem::path& file, const SceneHeader& header, int version,
                std::span<const std::string_view> known)
      : file_(file), header_(header), version_(version), known_(known) {}

  void read(pugi::xml_node group, int depth) {
    if (depth > 64) throw InputError(file_, "OctTreeGroup", "groups nest deeper than 64");
    for (const pugi::xml_node child : group.children()) {
      const std::string_view name = child.name();
      const SceneAttributes a(file_, child);
      if (name == "OctTreeGroup") read_group(child, a, depth);
      if (name == "PagedOctTree") read_cell_of(a);
      if (name == "Loss") read_loss(a);
    }
  }
  GroupContent content;

 private:
  void faults(std::vector<SceneFault> all) { std::move(all.begin(), all.end(), std::back_inserter(content.faults)); }

  void read_group(pugi::xml_node group, const SceneAttributes& a, int depth) {
    static const std::vector<std::string_view> of_reference = with_totals(
        {"GroupFile", "GroupChecksum", "BlockMin", "BlockVoxels", "Groups", "CenterX", "CenterY", "CenterZ", "Radius"});
    static constexpr std::string_view parts[] = {"OctTreeGroup", "PagedOctTree", "Loss"};
    if (version_ < 3 || !a.has("GroupFile")) {
      faults(a.unknown_parts(known_, parts));
      return read(group, depth + 1);
    }
    content.pages.push_back(read_reference(a, version_));
    check_sphere(a, content.pages.back().totals.window);
    faults(a.unknown_parts(of_reference, {}));
  }

  void read_cell_of(const SceneAttributes& a) {
    static constexpr std::string_view known[] = {"CenterX",    "CenterY",    "CenterZ",     "Radius",      "TreeFile",
                                                 "Name",       "LatticeMin", "CellVoxels",  "Lods",        "Bytes",
                                                 "Triangles",  "Voxels",     "Fingerprint", "ContentHash", "FirstLod",
                                                 "LevelBytes", "NodeBytes",  "CopiedLods"};
    SceneCell cell = read_cell(a, version_);
    check_sphere(a, window_of(cell));
    (cell.first_lod == 0 ? content.cells : content.overviews).push_back(std::move(cell));
    faults(a.unknown_parts(std::span(known).first(version_ < 3 ? 15 : version_ == 3 ? 17 : 18), {}));
  }

  void read_loss(const SceneAttributes& a) {
    static constexpr std::string_view known[] = {"Name", "Reason"};
    content.losses.push_back({a.text("Name"), a.text("Reason")});
    faults(a.unknown_parts(known, {}));
  }

  /// Checks the bounding sphere, which follows from the window.
  void check_sphere(const SceneAttributes& a, const Box3i64& window) {
    const char* const centre[3] = {"CenterX", "CenterY", "CenterZ"};
    double square = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double low_m = double(window.min[c]) * header_.voxel_size_m;
      const double edge_m = double(window.end[c] - window.min[c]) * header_.voxel_size_m;
      const double size = std::fabs(header_.lattice_origin_m[c]) + std::fabs(low_m) + edge_m;
      check_number(a, centre[c], header_.lattice_origin_m[c] + low_m + edge_m / 2, size);
      square += edge_m * edge_m;
    }
    check_number(a, "Radius", std::sqrt(square) / 2, std::sqrt(square));
  }

  /// Checks a number up to rounding. `size` is the magnitude of the numbers that it was computed from.
  void check_number(const SceneAttributes& a, const char* key, double expected, double size) {
    const auto said = a.has(key) ? parsed_number(a.text(key)) : std::nullopt;
    if (!said || !(std::fabs(*said - expected) <= 1e-12 * size))
      content.faults.push_back(
          a.fault(key, fmt::format("expected {}, which follows from LatticeMin and CellVoxels", expected)));
  }

  const std::filesystem::path& file_;
  const SceneHeader& header_;
  int version_;
  std::span<const std::string_view> known_;
};

}  // namespace

LatticeBlock block_around(const Vec3i64& voxel, std::int64_t edge) {
  return {Vec3i64::by_axis([&](int axis) { return voxel[axis] & -edge; }), edge};
}

bool lies_in(const SceneCell& shard, const LatticeBlock& block) {
  return intersection(window_of(shard), block.box()) == window_of(shard);
}

GroupContent read_content(const std::filesystem::path& file, pugi::xml_node group, const SceneHeader& header,
                          int version, std::span<const std::string_view> known) {
  ContentReader reader(file, header, version, known);
  reader.read(group, 0);
  if (!reader.content.cells.empty() && !reader.content.pages.empty())
    SceneAttributes(file, group).fail("", "has both cells and pages; expected only one of the two");
  return std::move(reader.content);
}

pugi::xml_node root_of(const std::filesystem::path& file, const pugi::xml_document& document,
                       std::vector<SceneFault>& faults) {
  const pugi::xml_node group = document.child("OctTreeGroup");
  if (!group) throw InputError(file, "OctTreeGroup", "is missing; expected the scene.xml of a bake");
  for (const pugi::xml_node other : document.children())
    if (other.type() == pugi::node_element && other != group)
      faults.push_back(SceneAttributes(file, other).fault("", "is a second root; expected one OctTreeGroup"));
  return group;
}

SceneTotals read_totals(const SceneAttributes& a, int version) {
  SceneTotals t;
  t.cells = a.value<std::uint64_t>("Cells");
  if (version >= 5) t.overviews = a.value<std::uint64_t>("Parents");
  t.voxels = a.values<std::uint64_t>("Voxels");
  t.content_hash = a.hashes("LevelContentHash");
  if (t.content_hash.size() != t.voxels.size()) a.fail("LevelContentHash", "expected one hash for each of Voxels");
  if (a.hash("ContentHash") != t.all_content()) a.fail("ContentHash", "is not the sum of LevelContentHash");
  t.bytes = a.value<std::uint64_t>("Bytes");
  if (a.has("LevelBytes") || a.has("NodeBytes")) {
    t.level_bytes = a.values<std::uint64_t>("LevelBytes");
    t.node_bytes = a.value<std::uint64_t>("NodeBytes");
    if (t.level_bytes.size() != t.voxels.size()) a.fail("LevelBytes", "expected one number for each of Voxels");
  }
  if (a.has("CellVoxels")) t.cell_voxels = a.value<std::uint32_t>("CellVoxels");
  if (t.cells == 0) return t;
  t.window = read_box(a, "LatticeMin", "LatticeEnd");
  return t;
}

Box3i64 read_box(const SceneAttributes& a, const char* min_key, const char* end_key) {
  const Box3i64 box{a.triple<std::int64_t>(min_key), a.triple<std::int64_t>(end_key)};
  for (std::size_t c = 0; c < 3; ++c)
    if (box.min[c] < -max_voxel || box.end[c] > max_end || box.min[c] >= box.end[c])
      a.fail(min_key, fmt::format("expected a box of the lattice within ±2^53, up to {}", end_key));
  return box;
}

LatticeBlock read_block(const SceneAttributes& a) {
  LatticeBlock block{a.triple<std::int64_t>("BlockMin"), a.value<std::int64_t>("BlockVoxels")};
  if (block.edge < 8 || block.edge > max_end || !std::has_single_bit(std::uint64_t(block.edge)))
    a.fail("BlockVoxels", "expected a power of two from 8 to 2^53");
  for (const std::int64_t x : block.min)
    if (x < -max_end || x > max_end || x % block.edge != 0)
      a.fail("BlockMin", "expected multiples of BlockVoxels within ±2^53");
  return block;
}

void read_lattice(const SceneAttributes& a, SceneHeader& header) {
  header.voxel_size_m = a.value<double>("VoxelSize");
  if (!(header.voxel_size_m > 0)) a.fail("VoxelSize", "expected a positive number of metres");
  header.lattice_origin_m = a.triple<double>("LatticeOrigin");
  const auto channels = parse_channels(a.text("Channels"));
  if (!channels) a.fail("Channels", "expected 'rgba', optionally followed by 'normal', 'facing' and 'class'");
  header.has_normals = channels->normals, header.has_directional_coverage = channels->directional_coverage;
  header.has_classes = channels->classes;
}

std::vector<SceneFault> faults_of_root(const SceneAttributes& root, std::span<const std::string_view> known) {
  static constexpr std::string_view parts[] = {"OctTreeGroup", "PagedOctTree", "Loss"};
  std::vector<SceneFault> faults;
  if (!root.has("Compressed") || root.text("Compressed") != "1")
    faults.push_back(root.fault("Compressed", "expected 1"));
  for (const char* key : {"BrickXSize", "BrickYSize", "BrickZSize"})
    if (!root.has(key) || root.text(key) != "8") faults.push_back(root.fault(key, "expected 8"));
  std::vector<SceneFault> unknown = root.unknown_parts(known, parts);
  std::move(unknown.begin(), unknown.end(), std::back_inserter(faults));
  return faults;
}

std::vector<std::string_view> with_totals(std::vector<std::string_view> others) {
  others.insert(others.begin(), {"Cells", "Parents", "Voxels", "ContentHash", "LevelContentHash", "Bytes", "LevelBytes",
                                 "NodeBytes", "CellVoxels", "LatticeMin", "LatticeEnd"});
  return others;
}

std::vector<SceneFault> faults_of_blocks(const std::vector<PageReference>& pages, const LatticeBlock* outer) {
  std::vector<SceneFault> faults;
  std::set<Vec3i64> seen;
  for (const PageReference& page : pages) {
    const std::string key = "OctTreeGroup " + as_line(page.file, max_quote_bytes);
    if (page.block.edge != pages[0].block.edge)
      faults.push_back({key, "has a block of another size than its neighbours", {}});
    if (!seen.insert(page.block.min).second) faults.push_back({key, "another page has the same block", {}});
    if (outer != nullptr && (page.block.edge >= outer->edge || block_around(page.block.min, outer->edge) != *outer))
      faults.push_back({key, "its block is not inside the block of the group above it", {}});
  }
  return faults;
}

std::vector<SceneFault> faults_of_totals(const SceneTotals& said, const SceneTotals& are, const std::string& element) {
  std::vector<SceneFault> faults;
  const auto expect = [&](bool holds, const char* key) {
    if (!holds)
      faults.push_back(
          {element + " " + key, "differs from the cells below; lines were lost, added or changed: bake again", {}});
  };
  expect(said.cells == are.cells, "Cells");
  expect(said.overviews == are.overviews, "Parents");
  expect(said.voxels == are.voxels, "Voxels");
  expect(said.content_hash == are.content_hash, "LevelContentHash");
  expect(said.bytes == are.bytes, "Bytes");
  expect(said.level_bytes == are.level_bytes, "LevelBytes");
  expect(said.node_bytes == are.node_bytes, "NodeBytes");
  expect(said.cell_voxels == are.cell_voxels, "CellVoxels");
  expect(said.window == are.window, "LatticeMin");
  return faults;
}

}  // namespace gigabake
