// Edits: shapes on the lattice, lists as JSON, and which cells an edit selects voxels of.
#include <gtest/gtest.h>
#include <random>

#include "core/base/error.h"
#include "format/edit/edit_json.h"
#include "format/edit/edits_in_scene.h"
#include "tests/random_seed.h"

namespace gigabake {
namespace {

constexpr SnapFrame test_frame{0.5, {0.25, -3, 7}};

/// A random edit within 40 voxels of the lattice's origin, with many coordinates on centres or borders of voxels.
class RandomEdits {
 public:
  explicit RandomEdits(std::uint64_t seed) : random_(seed) {}

  Edit edit(EditType type) {
    Edit e;
    e.type = type;
    e.rgb = {std::uint8_t(number(0, 255)), 2, 3};
    const std::array<double, 3> at{metres(), metres(), metres()};
    switch (number(0, 3)) {
      case 0:
        e.shape = BoxShape{at, {at[0] + length(), at[1] + length(), at[2] + length()}};
        break;
      case 1:
        e.shape = SphereShape{at, length()};
        break;
      case 2:
        e.shape = CylinderShape{at, length(), length()};
        break;
      default: {
        const double a = length(), b = length();
        e.shape = PrismShape{{{{at[0], at[1]}, {at[0] + a, at[1] - b}, {at[0] + a + b, at[1] + a}}}, at[2], at[2] + a};
      }
    }
    return e;
  }

  int number(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

 private:
  double metres() {
    const double value = std::uniform_real_distribution<double>(-12, 12)(random_);
    return number(0, 1) == 0 ? value : std::floor(value * 4) / 4;
  }
  double length() { return 0.1 + std::abs(metres()); }

  std::mt19937_64 random_;
};

/// Counts the selected voxels of a box one by one.
std::size_t count(const EditsInScene& edits, std::uint32_t e, const Box3i64& box) {
  std::size_t selected = 0;
  for (std::int64_t z = box.min[2]; z < box.end[2]; ++z)
    for (std::int64_t y = box.min[1]; y < box.end[1]; ++y)
      for (std::int64_t x = box.min[0]; x < box.end[0]; ++x) selected += edits.selects(e, {x, y, z}) ? 1 : 0;
  return selected;
}

TEST(EditsInScene, ClassifiesBoxesAsTheirVoxels) {
  const test::RandomSeed seed;
  RandomEdits random(seed);
  for (int round = 0; round < 300; ++round) {
    const auto list = std::make_shared<const EditList>(EditList{random.edit(EditType::carve)});
    const EditsInScene edits(list, std::nullopt, test_frame);
    SCOPED_TRACE(to_json((*list)[0]));
    const Vec3i64 corner{random.number(-40, 30), random.number(-40, 30), random.number(-40, 30)};
    const std::int64_t edge = random.number(0, 1) == 0 ? 8 : 16;
    const auto box = Box3i64::cube(corner, edge);
    const std::size_t selected = count(edits, 0, box);
    const AreaOverlap found = edits.overlap(0, box);
    const auto all = std::size_t(edge * edge * edge);
    EXPECT_TRUE(found == AreaOverlap::border || selected == (found == AreaOverlap::inside ? all : 0));
    EXPECT_EQ(edits.selects_any(0, box), selected != 0);
    EXPECT_EQ(edits.selecting(box).size(), selected != 0 ? 1u : 0u);
    EXPECT_EQ(count(edits, 0, {edits.bounds(0).min - Vec3i64::all(2), edits.bounds(0).end + Vec3i64::all(2)}),
              count(edits, 0, edits.bounds(0)));
  }
}

TEST(EditsInScene, ListsAndSelectsTheSameVoxelsOfABrick) {
  const test::RandomSeed seed;
  RandomEdits random(seed);
  for (int round = 0; round < 50; ++round) {
    const auto list = std::make_shared<const EditList>(EditList{random.edit(EditType::fill)});
    const EditsInScene edits(list, std::nullopt, test_frame);
    const Vec3i64 min{8 * random.number(-3, 3), 8 * random.number(-3, 3), 8 * random.number(-3, 3)};
    const BrickMask mask = edits.selected(0, min);
    for (int i = 0; i < brick_voxels; ++i)
      EXPECT_EQ((mask[std::size_t(i) / 64] >> i % 64 & 1) != 0,
                edits.selects(0, min + Vec3i64{i % 8, i / 8 % 8, i / 64}));
  }
}

TEST(EditsInScene, ContainsTheLowerBoundOfABoxAndNotTheUpper) {
  Edit edit;
  edit.shape = BoxShape{{0.5, -2.75, 7.25}, {1, -2.25, 7.75}};  // from centres of voxels to centres of the next
  const EditsInScene edits(std::make_shared<const EditList>(EditList{edit}), std::nullopt, test_frame);
  EXPECT_EQ(count(edits, 0, Box3i64::cube({-4, -4, -4}, 8)), 1u);
  EXPECT_TRUE(edits.selects(0, {0, 0, 0}));
}

TEST(EditsInScene, ContainsTheSurfaceOfASphere) {
  Edit edit;
  edit.shape = SphereShape{{0.5, -2.75, 7.25}, 1};  // around a centre, with a radius of two voxels
  const EditsInScene edits(std::make_shared<const EditList>(EditList{edit}), std::nullopt, test_frame);
  EXPECT_TRUE(edits.selects(0, {2, 0, 0}) && edits.selects(0, {0, -2, 0}) && edits.selects(0, {0, 0, 2}));
  EXPECT_EQ(count(edits, 0, Box3i64::cube({-4, -4, -4}, 8)), 33u);  // positions of whole numbers within distance 2
}

TEST(EditJson, ReturnsTheSameEdits) {
  const test::RandomSeed seed;
  RandomEdits random(seed);
  EditList edits;
  for (int i = 0; i < 200; ++i) {
    edits.push_back(random.edit(EditType(random.number(0, 2))));
    if (edits.back().type == EditType::paint && i % 2 == 0) edits.back().alpha = std::uint8_t(i % 255 + 1);
  }
  const std::string text = to_json(edits);
  const EditList found = edits_from_json("edits.json", text);
  EXPECT_EQ(to_json(found), text);
  ASSERT_EQ(found.size(), edits.size());
  for (std::size_t i = 0; i < edits.size(); ++i) EXPECT_EQ(hash_of(found[i]), hash_of(edits[i]));
  EXPECT_EQ(found[7].key, "edits[7]");
  EXPECT_EQ(found[7].file, "edits.json");
}

TEST(EditJson, RefusesAnyTextThatIsNoList) {
  for (const char* text : {"", "[]", "{\"edit\": []}", "{\"edits\": 3}", "{\"edits\": [3]}", "{\"edits\": [{}]}",
                           "{\"edits\": [{\"type\": \"carve\", \"prism\": {\"rings_m\": 3}}]}"})
    EXPECT_THROW(edits_from_json("edits.json", text), UsageError) << text;
}

}  // namespace
}  // namespace gigabake
