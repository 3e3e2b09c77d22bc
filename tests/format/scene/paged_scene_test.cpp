#include "format/scene/paged_scene.h"

#include <gtest/gtest.h>
#include <map>
#include <set>

#include "core/base/error.h"
#include "format/export/nanovdb/nanovdb.h"
#include "format/scene/check/diff.h"
#include "format/scene/check/scene_checksum.h"
#include "format/scene/check/verify.h"
#include "format/scene/scene_level.h"
#include "format/scene/stored_bytes.h"
#include "format/scene/xml/page_write.h"
#include "format/scene/xml/scene_reading.h"
#include "format/system/publish.h"
#include "tests/format/scene/scene_voxels.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;
using made::TempFolder;

/// The limits of pages. They are low enough for a few cells to make two levels of pages.
const PageRule small_pages{4, 2, 8};

SceneCell random_cell(std::mt19937_64& rng, const Vec3i64& at) {
  const std::string name = "c_" + std::to_string(rng());
  const auto hash = [&rng] { return Hash128{rng(), rng()}; };
  return {name,
          "shards/" + name + ".h5",
          {16 * at[0], 16 * at[1], 16 * at[2] + 8},
          16,
          2,
          rng() % 1000,
          rng() % 9,
          {rng() % 99, 7},
          hash(),
          {hash(), hash()},
          {rng() % 50, 9},
          3};
}

/// Returns an overview of random_cell() cells.
SceneCell random_overview(std::mt19937_64& rng, std::int64_t at) {
  SceneCell overview = random_cell(rng, {4 * at, 0, 0});
  overview.lattice_min[2] = 0;
  overview.first_lod = 2;
  overview.cell_voxels <<= overview.first_lod;
  return overview;
}

/// Returns cells at random places of a box, one cell far away, and two overviews; their shards do not exist.
SceneDescription random_cells(std::mt19937_64& rng) {
  SceneDescription scene;
  scene.generator = "gigabake test";
  scene.voxel_size_m = 0.5;
  std::set<Vec3i64> places;
  const std::int64_t far = (std::int64_t(1) << 10) * (rng() % 2 == 0 ? 1 : -1);
  for (int i = 0; i < 60; ++i)
    places.insert({std::int64_t(rng() % 12) - 6 + (i % 10 == 0 ? far : 0), std::int64_t(rng() % 12) - 6,
                   std::int64_t(rng() % 3)});
  for (const auto& place : places) scene.cells.push_back(random_cell(rng, place));
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  for (int i = 0; i < 2; ++i) scene.overviews.push_back(random_overview(rng, i));
  return scene;
}

std::vector<std::string> names_of(const std::vector<SceneCell>& cells) {
  std::vector<std::string> names;
  for (const SceneCell& cell : cells) names.push_back(cell.name);
  return names;
}

/// Returns names and contents of the files in pages/.
std::map<std::string, std::string> pages_in(const TempFolder& folder) {
  std::map<std::string, std::string> pages;
  for (const auto& entry : fs::directory_iterator(folder / "pages"))
    pages["pages/" + entry.path().filename().string()] = made::bytes_of(entry.path());
  return pages;
}

TEST(PagedScene, HasTheCellsAndSumsOfTheSceneThatWasWritten) {
  const TempFolder folder;
  for (int round = 0; round < 4; ++round) {
    const test::RandomSeed seed(round);
    std::mt19937_64 rng(seed);
    const SceneDescription scene = random_cells(rng);
    write_scene(folder / "scene.xml", scene, {4, 2u << rng() % 3, 1 + rng() % 8});
    const PagedScene paged(folder / "scene.xml");
    EXPECT_TRUE(paged.root().cells.empty());
    EXPECT_EQ(paged.totals(), SceneTotals(scene));
    const SceneDescription read = read_scene(folder / "scene.xml");
    ASSERT_EQ(names_of(read.cells), names_of(scene.cells));
    EXPECT_EQ(names_of(read.overviews), names_of(scene.overviews));
    EXPECT_EQ(names_of(paged.overviews()), names_of(scene.overviews));
    EXPECT_EQ(paged.totals().overviews, 2u);
    EXPECT_EQ(paged.totals().voxels.size(), 4u);
    EXPECT_EQ(SceneTotals(read), SceneTotals(scene));
    std::vector<SceneCell> walked(1000);
    paged.for_each_page(ThreadPool(2),
                        [&](std::size_t page, std::span<const SceneCell> cells) { walked.at(page) = cells[0]; });
    for (const PageReference& leaf : paged.leaves()) EXPECT_EQ(leaf.groups, 0u);
    const std::vector<PageReference> leaves = paged.leaves();
    for (std::size_t i = 0; i < leaves.size(); ++i)
      EXPECT_EQ(block_around(walked[i].lattice_min, leaves[i].block.edge), leaves[i].block);
  }
}

/// Returns a point with coordinates from 0 to `range` - 1.
Vec3i64 random_point(std::mt19937_64& rng, std::uint64_t range) {
  return Vec3i64::by_axis([&](int) { return std::int64_t(rng() % range); });
}

TEST(PagedScene, FindsTheCellsThatOverlapABox) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const SceneDescription scene = random_cells(rng);
  write_scene(folder / "scene.xml", scene, small_pages);
  const PagedScene paged(folder / "scene.xml");
  for (int round = 0; round < 20; ++round) {
    const Vec3i64 min = random_point(rng, 200) - Vec3i64::all(100);
    const Box3i64 box{min, min + Vec3i64::all(1) + random_point(rng, 60)};
    std::vector<SceneCell> expected;
    for (const SceneCell& cell : scene.cells)
      if (!intersection(window_of(cell), box).is_empty()) expected.push_back(cell);
    EXPECT_EQ(names_of(paged.cells_in(box)), names_of(expected));
  }
}

TEST(PagedScene, OfOneChangedCellHasOneNewPageOfEachLevelAndTheOldSceneStaysWhole) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  SceneDescription scene = random_cells(rng);
  write_scene(folder / "scene.xml", scene, small_pages);
  fs::copy_file(folder / "scene.xml", folder / "before.xml");
  const auto before = pages_in(folder);
  scene.cells[7].content_hash[0] = {1, 2};
  write_scene(folder / "scene.xml", scene, small_pages);
  const auto both = pages_in(folder);
  for (const auto& [name, bytes] : before) EXPECT_EQ(both.at(name), bytes);
  std::set<std::int64_t> levels;
  std::size_t changed = 0;
  PagedScene(folder / "scene.xml").for_each_reference([&](const PageReference& page) {
    changed += !before.contains(page.file);
    levels.insert(page.block.edge);
  });
  EXPECT_GE(levels.size(), 2u);
  EXPECT_EQ(changed, levels.size());
  EXPECT_EQ(read_scene(folder / "before.xml").cells[7].content_hash[0],
            PagedScene(folder / "before.xml").all().cells[7].content_hash[0]);
  remove_unused_pages(folder / "scene.xml");
  EXPECT_EQ(pages_in(folder).size(), before.size());
  EXPECT_EQ(read_scene(folder / "scene.xml").cells[7].content_hash[0], (Hash128{1, 2}));
}

/// Writes a random overview of four levels for cells of 64 voxels.
SceneCell write_random_overview(const fs::path& scene_xml, const SceneCell& cell, std::mt19937_64& rng) {
  std::vector<made::Voxel> voxels;
  for (std::int64_t i = 0; i < 40; ++i)
    voxels.push_back({{i, std::int64_t(rng() % 64), i / 2}, {std::uint8_t(rng()), 2, 3, 255}, {4, 5}});
  Shard overview = made::shard_of(voxels, {0, 0, 0}, 64);
  overview.header = read_shard_header(scene_xml.parent_path() / cell.file);
  overview.header.cell = "p4_0_0_0";
  overview.header.lattice_min = {-512, -512, -512};
  overview.header.first_lod = 4;
  overview.header.cell_voxels <<= 4;
  overview.nodes.directional_coverage.assign(overview.nodes.key.size(), {});
  for (BrickLevel& level : overview.levels)
    for (std::size_t v = 0; v < level.rgba.size() / 4; ++v)
      level.directional_coverage.insert(level.directional_coverage.end(), {7, 8, 9, 0x1a});
  return made::write_shard_of(scene_xml, made::with_content_hash(std::move(overview)));
}

/// A scene of adjacent cells and an overview, written once with pages and once without. Its shards exist.
struct TwoForms {
  TwoForms(const TempFolder& folder, std::mt19937_64& rng) : flat(folder / "flat.xml"), paged(folder / "scene.xml") {
    scene = made::write_random_scene(flat, rng, true);
    scene.overviews.push_back(write_random_overview(flat, scene.cells[0], rng));
    write_scene(flat, scene);
    write_scene(paged, scene, {1, 2, 2});
  }
  fs::path flat, paged;
  SceneDescription scene;
};

TEST(PagedScene, IsTheSameToEveryWalkerAsTheSceneWithoutPages) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  const TwoForms scene(folder, rng);
  ASSERT_FALSE(PagedScene(scene.paged).root().pages.empty());
  const VerifyResult flat = verify_scene(scene.flat, 2), paged = verify_scene(scene.paged, 2);
  EXPECT_EQ(paged.faults, std::vector<std::string>());
  EXPECT_EQ(paged.voxels, flat.voxels);
  EXPECT_EQ(paged.bytes, flat.bytes);
  EXPECT_EQ(paged.cells, scene.scene.cells.size());
  const PagedScene opened(scene.paged);
  EXPECT_EQ(opened.totals(), PagedScene(scene.flat).totals());
  EXPECT_EQ(stored_bytes(opened).of_lod, opened.totals().level_bytes);
  EXPECT_EQ(stored_bytes(opened).of_nodes, opened.totals().node_bytes);
  // Every level that `info` lists can be exported; the next coarser level is refused (fixed 2026-11-25).
  const int levels = static_cast<int>(opened.totals().level_bytes.size());
  EXPECT_NO_THROW(open_scene_level(scene.paged, levels - 1));
  EXPECT_THROW(open_scene_level(scene.paged, levels), InputError);
  EXPECT_TRUE(diff_scenes(scene.flat, scene.paged).same());
  EXPECT_EQ(made::voxels_of_scene(scene.flat, 1), made::voxels_of_scene(scene.paged, 1));
  export_nanovdb(scene.flat, 0, folder / "flat.nvdb");
  export_nanovdb(scene.paged, 0, folder / "paged.nvdb");
  EXPECT_EQ(made::bytes_of(folder / "flat.nvdb"), made::bytes_of(folder / "paged.nvdb"));
}

TEST(PagedScene, WithAnotherOrADamagedOverviewDiffersOrIsNotWhole) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  TwoForms a(folder, rng);
  SceneDescription other = a.scene;
  fs::create_directory(folder / "b");
  fs::copy(folder / "shards", folder / "b" / "shards", fs::copy_options::recursive);
  other.overviews[0] = write_random_overview(folder / "b" / "scene.xml", other.cells[0], rng);
  write_scene(folder / "b" / "scene.xml", other, {1, 2, 2});
  const SceneDifference difference = diff_scenes(a.paged, folder / "b" / "scene.xml");
  ASSERT_EQ(difference.cells.size(), 1u);
  EXPECT_EQ(difference.cells[0].cell_in_a, "p4_0_0_0");
  EXPECT_EQ(difference.cells[0].levels.front().lod, 4);
  fs::resize_file(folder / a.scene.overviews[0].file, 999);
  const std::vector<std::string> faults = verify_scene(a.paged, 1).faults;
  ASSERT_FALSE(faults.empty());
  EXPECT_NE(faults[0].find(a.scene.overviews[0].file), std::string::npos) << faults[0];
}

TEST(PagedScene, DiffNamesTheCellsThatDifferAndReadsNoPageThatIsAlike) {
  const test::RandomSeed seed;
  std::mt19937_64 rng(seed);
  const TempFolder folder;
  std::vector<Shard> shards;
  for (int i = 0; i < 6; ++i) {
    Shard shard = made::random_shard(rng, {2, true, 5});
    shard.header.cell = "c_" + std::to_string(i);
    shard.header.lattice_min = {64 * i, 0, 0};
    shard.header.origin.reset();
    shards.push_back(made::with_content_hash(std::move(shard)));
  }
  write_scene(folder / "scene.xml", made::write_scene_of(folder / "flat.xml", shards), {1, 2, 9});
  Shard other = made::random_shard(rng, {2, true, 5});
  other.header = shards[3].header;
  shards[3] = made::with_content_hash(std::move(other));
  fs::create_directory(folder / "b");
  write_scene(folder / "b" / "scene.xml", made::write_scene_of(folder / "b" / "flat.xml", shards), {1, 2, 9});
  const PagedScene paged(folder / "scene.xml");
  ASSERT_EQ(paged.leaves().size(), 6u);
  fs::remove(folder / paged.leaves()[0].file);
  const SceneDifference difference = diff_scenes(folder / "scene.xml", folder / "b" / "scene.xml");
  ASSERT_EQ(difference.cells.size(), 1u);
  EXPECT_EQ(difference.cells[0].cell_in_a, "c_3");
}

std::string replaced_in(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// A scene whose pages a test edits; all checksums above an edited page are corrected.
class Forgery {
 public:
  explicit Forgery(const TempFolder& folder) : folder_(folder) {
    std::mt19937_64 rng(3);
    SceneDescription row;
    row.voxel_size_m = 0.5;
    for (int i = 0; i < 16; ++i) row.cells.push_back(random_cell(rng, {i, 0, 0}));
    write_scene(folder / "scene.xml", row, {4, 2, 4});
    const PagedScene scene(folder / "scene.xml");
    above_ = scene.root().pages.at(0);
    leaf_ = read_page(folder / "scene.xml", scene.header(), above_).pages.at(0);
  }
  const PageReference& above() const { return above_; }
  const PageReference& leaf() const { return leaf_; }
  void edit_leaf(const std::string& from, const std::string& to) {
    const Hash128 checksum = edit(leaf_.file, from, to);
    edit_above(leaf_.checksum.hex() + "\" Block", checksum.hex() + "\" Block");
  }
  void edit_above(const std::string& from, const std::string& to) {
    const Hash128 checksum = edit(above_.file, from, to);
    edit("scene.xml", above_.checksum.hex() + "\" Block", checksum.hex() + "\" Block");
  }
  Hash128 edit(const std::string& file, const std::string& from, const std::string& to) {
    const SummedText text = summed(replaced_in(made::bytes_of(folder_ / file), from, to));
    publish_file(folder_ / file, text.text);
    return text.checksum;
  }

 private:
  const TempFolder& folder_;
  PageReference above_, leaf_;
};

std::string complaint(const fs::path& scene_xml) {
  try {
    read_scene(scene_xml);
    return "none";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PagedScene, WithAPageThatIsNotTheOneThatIsMeantIsRefusedByFileAndReason) {
  using Break = std::function<void(Forgery&, const TempFolder&)>;
  const auto leaf = [](const char* from, const char* to) {
    return Break([=](Forgery& f, const TempFolder&) { f.edit_leaf(from, to); });
  };
  const auto above = [](const char* from, const char* to) {
    return Break([=](Forgery& f, const TempFolder&) { f.edit_above(from, to); });
  };
  const struct {
    Break breaks;
    const char* told;
  } cases[] = {
      {[](Forgery& f, const TempFolder& d) { fs::remove(d / f.leaf().file); },
       "is missing, but the scene refers to it"},
      {[](Forgery& f, const TempFolder& d) { fs::resize_file(d / f.leaf().file, 99); }, "not a scene"},
      {[](Forgery& f, const TempFolder&) { f.edit(f.leaf().file, "Bytes=\"", "Bytes=\"1"); },
       "Checksum: is not the page"},
      {[](Forgery& f, const TempFolder& d) {
         fs::copy_file(d / f.above().file, d / f.leaf().file, fs::copy_options::overwrite_existing);
       },
       "Checksum: is not the page"},
      // A page that refers to itself. No text contains its own checksum, and no block lies in itself.
      {[](Forgery& f, const TempFolder&) { f.edit_above(f.leaf().file, f.above().file); }, "Checksum: is not the page"},
      {above("Groups=\"0\"", "Groups=\"1\""), "Groups: differs from its reference"},
      {leaf("VoxelSize=\"0.5\"", "VoxelSize=\"0.25\""), "VoxelSize: a page of another scene"},
      {leaf("Channels=\"rgba normal\"", "Channels=\"rgba\""), "VoxelSize: a page of another scene"},
      {leaf("Version=\"5\"", "Version=\"6\""), "Version: expected 3 to 5"},
      {leaf("BlockVoxels=\"32\"", "BlockVoxels=\"16\""), "BlockMin: is of another block"},
      {leaf(" Cells=\"", " Cells=\"1"), "Cells: differs from its reference"},
      {leaf("Triangles=\"", "Triangle=\""), "PagedOctTree Triangles: is missing"},
      {leaf("CellVoxels=\"16\" Lods", "CellVoxels=\"32\" FirstLod=\"1\" CopiedLods=\"0\" Lods"),
       "differs from the cells below"},
      {above("BlockVoxels=\"32\"", "BlockVoxels=\"4611686018427387904\""), "BlockVoxels: expected a power of two"},
      {above("GroupFile=\"pages", "GroupFile=\"../pages"), "GroupFile: expected a path inside"},
      {above("Bytes=\"", "Bytes=\"1"), "Bytes: differs from its reference"},
  };
  for (const auto& c : cases) {
    const TempFolder folder;
    Forgery forgery(folder);
    c.breaks(forgery, folder);
    const std::string told = complaint(folder / "scene.xml");
    EXPECT_NE(told.find(c.told), std::string::npos) << told << "\n" << c.told;
    EXPECT_NE(told.find("/pages/g_"), std::string::npos) << told;
    const VerifyResult verified = verify_scene(folder / "scene.xml", 1);
    const auto says_so = [&](const std::string& fault) { return fault == told; };
    EXPECT_TRUE(std::any_of(verified.faults.begin(), verified.faults.end(), says_so)) << told;
  }
}

TEST(PagedScene, OfALatticeBeyondEveryBoundIsRefused) {
  const TempFolder folder;
  Forgery forgery(folder);
  const Box3i64 window = PagedScene(folder / "scene.xml").totals().window;
  forgery.edit("scene.xml", "LatticeEnd=\"" + std::to_string(window.end[0]), "LatticeEnd=\"4611686018427387904");
  EXPECT_NE(complaint(folder / "scene.xml").find("LatticeMin: expected a box of the lattice within"), std::string::npos)
      << complaint(folder / "scene.xml");
}

TEST(PagedScene, WhoseCellsOfTwoPagesOverlapOrHaveOneNameIsNotWhole) {
  const TempFolder folder;
  std::mt19937_64 rng(11);
  SceneDescription scene;
  scene.voxel_size_m = 0.5;
  for (int i = 0; i < 6; ++i) scene.cells.push_back(random_cell(rng, {0, 0, 4 * i}));
  // Cell 1 crosses the border of two blocks of 32 voxels.
  scene.cells[1].lattice_min[2] = 56;
  scene.cells[2].lattice_min[2] = 64;
  scene.cells[5].name = scene.cells[0].name;
  write_scene(folder / "scene.xml", scene, {1, 2, 9});
  const auto faults = verify_scene(folder / "scene.xml", 2).faults;
  const auto told = [&](const std::string& what) {
    return std::count_if(faults.begin(), faults.end(),
                         [&](const std::string& f) { return f.find(what) != std::string::npos; });
  };
  EXPECT_EQ(told(scene.cells[1].name + ": overlaps cell " + scene.cells[2].name), 1);
  EXPECT_EQ(told("another cell has the same name"), 2);
}

}  // namespace
}  // namespace gigabake
