// Overviews of a scene with pages: each is listed exactly once, in a page that a traversal from the root visits.
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>

#include "core/base/error.h"
#include "format/scene/check/diff.h"
#include "format/scene/check/scene_check.h"
#include "format/scene/check/scene_checksum.h"
#include "format/scene/check/verify.h"
#include "format/scene/paged_scene.h"
#include "format/scene/tier_shape.h"
#include "format/scene/xml/scene_reading.h"
#include "format/system/publish.h"
#include "tests/format/scene/scene_voxels.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;
using made::TempFolder;
using Corner = Vec3i64;

/// The limits of pages. They are low enough for a few cells to make three levels of pages.
const PageRule few_cells_a_page{4, 2, 8};

constexpr std::uint32_t cell_edge = 16, levels_a_tier = 2;

SceneCell listed_shard(std::mt19937_64& rng, const std::string& prefix, const Corner& min, std::uint32_t first_lod,
                       std::uint32_t edge) {
  SceneCell shard;
  shard.name = prefix + std::to_string(rng());
  shard.file = "shards/" + shard.name + ".h5";
  shard.lattice_min = min;
  shard.cell_voxels = edge;
  shard.first_lod = first_lod;
  shard.lods = levels_a_tier;
  shard.bytes = rng() % 1000;
  for (std::uint32_t lod = 0; lod < shard.lods; ++lod) {
    shard.voxels.push_back(1 + rng() % 99);
    shard.content_hash.push_back({rng(), rng()});
  }
  shard.fingerprint = {rng(), rng()};
  return shard;
}

/// Returns a scene of cell stacks on both sides of the lattice's corner and all their overviews. A stack begins at a
/// multiple of 8.
SceneDescription scene_below_one_root(std::mt19937_64& rng) {
  SceneDescription scene;
  scene.generator = "gigabake test";
  scene.voxel_size_m = 0.5;
  std::set<Corner> below;
  for (std::int64_t y = -7; y < 6; ++y)
    for (std::int64_t x = -9; x < 9; ++x) {
      if (rng() % 3 == 0) continue;
      const Corner min{cell_edge * x, cell_edge * y, 8 * std::int64_t(rng() % 12) - 40};
      scene.cells.push_back(listed_shard(rng, "c_", min, 0, cell_edge));
      below.insert(min);
      below.insert({min[0], min[1], min[2] + cell_edge - 1});
    }
  std::sort(scene.cells.begin(), scene.cells.end(), is_before);
  std::int64_t edge = cell_edge;
  for (std::uint32_t lod = levels_a_tier; edge < 1024; lod += levels_a_tier) {
    edge <<= levels_a_tier;
    std::set<Corner> tier;
    for (const Corner& v : below) tier.insert(edge == 1024 ? Corner{-512, -512, -512} : block_around(v, edge).min);
    for (const Corner& min : tier) scene.overviews.push_back(listed_shard(rng, "p_", min, lod, std::uint32_t(edge)));
    below = tier;
  }
  return scene;
}

std::set<std::string> set_of_names(const std::vector<SceneCell>& shards) {
  std::set<std::string> names;
  for (const SceneCell& shard : shards) EXPECT_TRUE(names.insert(shard.name).second) << shard.name;
  return names;
}

struct WrittenScene {
  explicit WrittenScene(const test::RandomSeed& seed) : rng(seed), scene(scene_below_one_root(rng)) {
    write_scene(folder / "scene.xml", scene, few_cells_a_page);
  }
  TempFolder folder;
  std::mt19937_64 rng;
  SceneDescription scene;
};

TEST(PagedOverviews, AreListedInTheInnermostPageAndTheRootInSceneXml) {
  const test::RandomSeed seed;
  const WrittenScene written(seed);
  const PagedScene paged(written.folder / "scene.xml");
  EXPECT_EQ(set_of_names(paged.overviews()), set_of_names(written.scene.overviews));
  EXPECT_EQ(paged.totals(), SceneTotals(written.scene));
  ASSERT_EQ(paged.header().tiers.size(), 3u);
  EXPECT_EQ(paged.header().tiers, tiers_of(written.scene, cell_edge));
  ASSERT_GE(paged.root().overviews.size(), 1u);
  EXPECT_EQ(paged.root().overviews.back().cell_voxels, 1024u);
  EXPECT_LT(paged.root().overviews.size(), written.scene.overviews.size() / 4);
  const SceneDescription all = read_scene(written.folder / "scene.xml");
  EXPECT_EQ(set_of_names(all.overviews), set_of_names(written.scene.overviews));
  EXPECT_TRUE(std::is_sorted(all.overviews.begin(), all.overviews.end(), is_overview_before));
  std::map<std::int64_t, int> by_edge;  // number of blocks of pages by their edge
  paged.for_each_reference([&](const PageReference& reference) {
    for (const SceneCell& overview : read_page(paged.file(), paged.header(), reference).overviews) {
      EXPECT_TRUE(lies_in(overview, reference.block));
      ++by_edge[reference.block.edge];
    }
  });
  EXPECT_GE(by_edge.size(), 2u) << "pages of several levels have overviews";
}

TEST(PagedOverviews, AreFoundByBoxAndLevel) {
  const test::RandomSeed seed;
  WrittenScene written(seed);
  const PagedScene paged(written.folder / "scene.xml");
  for (int round = 0; round < 60; ++round) {
    Box3i64 box;
    for (std::size_t c = 0; c < 3; ++c) {
      box.min[c] = std::int64_t(written.rng() % 400) - 200;
      box.end[c] = box.min[c] + 1 + std::int64_t(written.rng() % 60);
    }
    const int lod = int(written.rng() % 9);
    std::vector<SceneCell> expected;
    for (const SceneCell& overview : written.scene.overviews)
      if (int(overview.first_lod) <= lod && lod < int(overview.first_lod + overview.lods) &&
          !intersection(window_of(overview), box).is_empty())
        expected.push_back(overview);
    EXPECT_EQ(set_of_names(paged.overviews_in(box, lod)), set_of_names(expected));
  }
}

TEST(PagedOverviews, OfAChangedCellChangeOnePageOfEachLevel) {
  const test::RandomSeed seed;
  WrittenScene written(seed);
  const auto files = [&] {
    std::map<std::string, std::int64_t> edge_of;
    PagedScene(written.folder / "scene.xml").for_each_reference([&](const PageReference& page) {
      edge_of[page.file] = page.block.edge;
    });
    return edge_of;
  };
  const auto before = files();
  SceneDescription& scene = written.scene;
  const SceneCell& cell = scene.cells[scene.cells.size() / 2];
  scene.cells[scene.cells.size() / 2].content_hash[0] = {1, 2};
  for (SceneCell& overview : scene.overviews)
    if (window_of(overview).contains(cell.lattice_min)) overview.content_hash[0] = {3, 4};
  std::shuffle(scene.overviews.begin(), scene.overviews.end(), written.rng);  // the result does not depend on the order
  write_scene(written.folder / "scene.xml", scene, few_cells_a_page);
  std::map<std::int64_t, int> changed;
  std::set<std::int64_t> levels;
  for (const auto& [file, edge] : files()) {
    levels.insert(edge);
    changed[edge] += !before.contains(file);
  }
  EXPECT_GE(levels.size(), 2u);
  for (const auto& [edge, pages] : changed) EXPECT_EQ(pages, 1) << "with blocks of " << edge;
}

TEST(PagedOverviews, ThatStandInAWrongPageOrTwiceAreRefused) {
  const test::RandomSeed seed;
  const WrittenScene written(seed);
  const PagedScene paged(written.folder / "scene.xml");
  const auto tiers = paged.header().tiers;
  const PageReference* above = nullptr;
  for (const PageReference& page : paged.root().pages)
    if (page.groups != 0) above = &page;
  ASSERT_NE(above, nullptr);
  const ScenePage inner = read_page(paged.file(), paged.header(), *above);
  const auto below =
      std::ranges::find_if(inner.pages, [](const PageReference& page) { return page.totals.overviews != 0; });
  ASSERT_NE(below, inner.pages.end());
  std::vector<SceneCell> lower;
  paged.for_each_overview_below(*below, [&](const SceneCell& overview) { lower.push_back(overview); });
  const auto told = [&](const ScenePage& page, const LatticeBlock* outer) {
    std::string all;
    for (const SceneFault& fault : faults_of_overview_places(page, outer, tiers)) all += fault.message + "\n";
    return all;
  };
  EXPECT_EQ(told(inner, &above->block), "");
  EXPECT_EQ(told(paged.root(), nullptr), "");
  ScenePage page = inner;
  page.overviews.push_back(lower[0]);
  EXPECT_EQ(told(page, &above->block), "belongs to the block of a smaller page; expected it there\n");
  page = paged.root();
  page.overviews.push_back(lower[0]);
  EXPECT_EQ(told(page, nullptr), "belongs to the block of a smaller page; expected it there\n");
  page = {{}, {}, {lower[0]}};
  const LatticeBlock elsewhere = block_around({5000, 5000, 5000}, below->block.edge);
  EXPECT_EQ(told(page, &elsewhere), "does not lie in the block of its page\n");
  page = {{}, {}, {paged.root().overviews.back()}};
  const LatticeBlock all{{-4096, -4096, -4096}, 8192};
  EXPECT_EQ(told(page, &all), "is the root and is listed in a page; expected it in scene.xml\n");
  page = paged.root();
  page.overviews.push_back(paged.root().overviews.back());
  EXPECT_EQ(told(page, nullptr), "names a root that is missing or listed more than once; bake again\n");
  EXPECT_FALSE(faults_of_places({}, {lower[0], lower[0]}).empty()) << "twice in one page";
  page = {{}, {}, {lower[0]}};
  page.overviews[0].lods = 1;
  EXPECT_NE(told(page, &below->block).find("ParentTiers"), std::string::npos);
}

/// Replaces a text of scene.xml and corrects its checksum.
void edit_scene(const fs::path& file, const std::string& from, const std::string& to) {
  std::string text = made::bytes_of(file);
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  publish_file(file, summed(text.replace(at, from.size(), to)).text);
}

std::string refusal_of_scene(const fs::path& file) {
  try {
    const PagedScene scene(file);
    return "none";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(PagedOverviews, WhoseTiersSceneXmlContradictsAreRefused) {
  const struct {
    const char *tiers, *told;
  } cases[] = {{"", "expected three numbers"},
               {"2 0 2 4 0 2 6 0", "expected three numbers"},
               {"2 0 2 5 0 1 6 0 2", "lod 4 is missing or duplicated"},
               {"2 0 2 4 0 2", "has levels that ParentTiers does not list"},
               {"2 0 2 4 0 2 6 0 40", "are not numbers of overview levels"},
               {"2 0 4294967295 1 0 1", "are not numbers of overview levels"},
               {"2 2 2 4 0 2", "are not numbers of overview levels"},
               {"2 0 2 4 0 2 6 0 3", "has other levels"}};
  const test::RandomSeed seed;
  const WrittenScene written(seed);
  const std::string whole = made::bytes_of(written.folder / "scene.xml");
  for (const auto& c : cases) {
    publish_file(written.folder / "scene.xml", whole);
    edit_scene(written.folder / "scene.xml", "ParentTiers=\"2 0 2 4 0 2 6 0 2\"",
               "ParentTiers=\"" + std::string(c.tiers) + "\"");
    EXPECT_NE(refusal_of_scene(written.folder / "scene.xml").find(c.told), std::string::npos)
        << c.tiers << ": " << refusal_of_scene(written.folder / "scene.xml");
  }
}

TEST(PagedOverviews, ThatAreMissingAreNamedByVerifyThoughTheScenesSumsAgree) {
  const test::RandomSeed seed;
  WrittenScene written(seed);
  const auto says_so = [&] {
    const auto faults = verify_scene(written.folder / "scene.xml", 1).faults;
    return std::ranges::any_of(faults, [](const std::string& fault) {
      return fault.find("ParentTiers: an overview of cells or overviews is missing") != std::string::npos;
    });
  };
  EXPECT_FALSE(says_so());
  for (const std::size_t victim : {std::size_t(0), written.scene.overviews.size() - 2}) {
    SceneDescription lacking = written.scene;
    lacking.overviews.erase(lacking.overviews.begin() + std::ptrdiff_t(victim));
    lacking.losses.push_back({"parent p", "was not baked"});
    write_scene(written.folder / "scene.xml", lacking, few_cells_a_page);
    EXPECT_TRUE(PagedScene(written.folder / "scene.xml").header().tiers.empty());
    EXPECT_FALSE(says_so()) << "scene.xml does not say that all hangs from one root";
    edit_scene(written.folder / "scene.xml", "Parents=", "ParentTiers=\"2 0 2 4 0 2 6 0 2\" Parents=");
    EXPECT_TRUE(says_so());
  }
}

// 2026-11-25: if ParentTiers was missing, verify found no fault, and viewers listed all cells to find the root's
// children.
TEST(PagedOverviews, AreMissedByVerifyIfOverviewTiersIsRemoved) {
  const test::RandomSeed seed;
  const WrittenScene written(seed);
  edit_scene(written.folder / "scene.xml", " ParentTiers=\"2 0 2 4 0 2 6 0 2\"", "");
  EXPECT_TRUE(PagedScene(written.folder / "scene.xml").header().tiers.empty());
  const auto faults = verify_scene(written.folder / "scene.xml", 1).faults;
  EXPECT_TRUE(std::ranges::any_of(faults, [](const std::string& fault) {
    return fault.find("ParentTiers: is missing, although all cells have one root") != std::string::npos;
  }));
}

// 2026-11-24: verify reported a missing overview for blocks in which the cells are empty, so that none is baked.
TEST(PagedOverviews, OfBlocksThatHoldNothingOfACellAreNotMissed) {
  const test::RandomSeed seed;
  WrittenScene written(seed);
  SceneDescription sparse = written.scene;
  std::erase_if(sparse.cells, [](const SceneCell& cell) { return cell.lattice_min[2] >= 0; });
  const std::int64_t edge = cell_edge << levels_a_tier;
  std::set<Corner> begun;
  for (const SceneCell& cell : sparse.cells) begun.insert(block_around(cell.lattice_min, edge).min);
  const std::size_t removed = std::erase_if(sparse.overviews, [&](const SceneCell& overview) {
    return overview.cell_voxels == edge && !begun.contains(overview.lattice_min);
  });
  EXPECT_GT(removed, 0u);
  write_scene(written.folder / "scene.xml", sparse, few_cells_a_page);
  EXPECT_FALSE(PagedScene(written.folder / "scene.xml").header().tiers.empty());
  for (const std::string& fault : verify_scene(written.folder / "scene.xml", 1).faults)
    EXPECT_EQ(fault.find("ParentTiers"), std::string::npos) << fault;
}

TEST(PagedOverviews, OfScenesOfManyVersionsAreTheSame) {
  const fs::path golden = fs::path(GIGABAKE_SOURCE_DIR) / "tests/format/golden";
  const SceneDescription then = read_scene(golden / "pages_scene_4/scene.xml");
  if (std::getenv("GIGABAKE_WRITE_GOLDEN") != nullptr) write_scene(golden / "pages_scene_5/scene.xml", then, {4, 8, 2});
  const PagedScene old(golden / "pages_scene_4/scene.xml"), now(golden / "pages_scene_5/scene.xml");
  EXPECT_EQ(old.root().overviews.size(), old.totals().overviews) << "version 4 lists all of them in scene.xml";
  EXPECT_LT(now.root().overviews.size(), now.totals().overviews);
  EXPECT_EQ(old.totals(), now.totals());
  EXPECT_EQ(set_of_names(now.overviews()), set_of_names(then.overviews));
  EXPECT_EQ(now.header().tiers, tiers_of(then, then.cells.at(0).cell_voxels));
  EXPECT_TRUE(diff_scenes(golden / "pages_scene_4/scene.xml", golden / "pages_scene_5/scene.xml").same());
  const TempFolder folder;
  write_scene(folder / "scene.xml", then, {4, 8, 2});
  EXPECT_EQ(made::bytes_of(folder / "scene.xml"), made::bytes_of(golden / "pages_scene_5/scene.xml"))
      << "the current writer gives the bytes of the golden file";
}

}  // namespace
}  // namespace gigabake
