/// Every hard case, baked by bake_cell() and by the exact reference. Both must give the values derived by hand.
#include "bench/exact/hard_cases.h"

#include <fstream>
#include <gtest/gtest.h>

#include "bake_scene.h"
#include "core/base/rules.h"
#include "hard_values.h"
#include "print.h"

namespace gigabake::reference {
namespace {

using namespace gigabake::kernels;

std::vector<HardCase> all_hard_cases() {
  std::vector<HardCase> all = small_hard_cases();
  for (HardCase& c : wide_hard_cases()) all.push_back(std::move(c));
  return all;
}

const std::set<Voxel>& expected(const HardCase& c, SurfaceRule rule) {
  return rule == SurfaceRule::area ? c.area : rule == SurfaceRule::thin ? c.thin : c.conservative;
}

std::string text_of(const std::set<Voxel>& voxels) {
  std::ostringstream out;
  out << voxels.size() << " voxels:";
  for (const Voxel& v : voxels) out << " (" << v[0] << ' ' << v[1] << ' ' << v[2] << ')';
  return out.str();
}

std::set<Voxel> by_reference(const HardCase& c, SurfaceRule rule, const Window& window) {
  std::set<Voxel> out;
  for (const Triangle& t : c.triangles) out = out + occupied(t, rule, window);
  return out;
}

class HardCases : public testing::TestWithParam<HardCase> {};

TEST_P(HardCases, OccupiesTheVoxelsWorkedOutByHandUnderEveryRule) {
  const HardCase& c = GetParam();
  BakeScene scene;
  scene.set_window({hard_case_low, hard_case_low, hard_case_low}, hard_case_high - hard_case_low);
  for (const Triangle& t : c.triangles) scene.add_triangle(t);
  for (const SurfaceRule rule : {SurfaceRule::area, SurfaceRule::conservative, SurfaceRule::thin}) {
    scene.parameters.surface = rule;
    const auto baked = positions_of(voxels_at(scene.bake(), scene.parameters, 0));
    EXPECT_EQ(text_of(baked), text_of(expected(c, rule))) << "bake_cell, " << name_of(rule);
    EXPECT_EQ(text_of(by_reference(c, rule, scene.window())), text_of(expected(c, rule)))
        << "reference, " << name_of(rule);
  }
}

class HardValues : public testing::TestWithParam<HardValue> {};

TEST_P(HardValues, AreWhatWasWorkedOutByHand) {
  ASSERT_TRUE(GetParam().check) << "a case without a check asserts nothing";
  GetParam().check();
}

std::vector<HardValue> all_hard_values() {
  std::vector<HardValue> all = hard_colours();
  for (const auto& group : {hard_normals(), hard_inputs()}) all.insert(all.end(), group.begin(), group.end());
  return all;
}

std::multiset<std::string> names_in_tables() {
  std::multiset<std::string> names;
  for (const HardCase& c : all_hard_cases()) names.insert(c.name);
  for (const HardValue& v : all_hard_values()) names.insert(v.name);
  return names;
}

/// Returns the first column of every table under the heading "Hard cases".
std::multiset<std::string> names_in_document() {
  std::ifstream file(GIGABAKE_SOURCE_DIR "/docs/accuracy-hard-cases.md");
  std::multiset<std::string> names;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("## ", 0) == 0) inside = line == "## Hard cases";
    if (inside && line.rfind("| `", 0) == 0) names.insert(line.substr(3, line.find('`', 3) - 3));
  }
  return names;
}

TEST(HardCaseTables, AreListedInTheDocumentationNameByName) {
  EXPECT_EQ(names_in_document(), names_in_tables());
  EXPECT_GE(names_in_tables().size(), 50u);
}

template <class Row>
std::string test_name(const testing::TestParamInfo<Row>& row) {
  std::string name = row.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Table, HardCases, testing::ValuesIn(all_hard_cases()), test_name<HardCase>);
INSTANTIATE_TEST_SUITE_P(Table, HardValues, testing::ValuesIn(all_hard_values()), test_name<HardValue>);

}  // namespace
}  // namespace gigabake::reference
