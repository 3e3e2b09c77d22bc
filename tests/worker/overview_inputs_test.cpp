#include "worker/overview/overview_inputs.h"

#include <gtest/gtest.h>

namespace gigabake {
namespace {

OverviewChild child_of_bytes(std::size_t bytes) {
  OverviewChild child;
  child.source.rgba.resize(bytes);
  return child;
}

TEST(OverviewInputs, ReturnTheChildOfAName) {
  OverviewInputs inputs(100);
  inputs.keep("a", child_of_bytes(40));
  inputs.keep("b", child_of_bytes(60));
  ASSERT_NE(inputs.find("a"), nullptr);
  EXPECT_EQ(inputs.find("a")->source.rgba.size(), 40u);
  EXPECT_EQ(inputs.find("c"), nullptr);
  EXPECT_EQ(inputs.bytes(), 100u);
  inputs.keep("a", child_of_bytes(30));
  EXPECT_EQ(inputs.find("a")->source.rgba.size(), 30u) << "the latest of a name";
  EXPECT_EQ(inputs.bytes(), 90u);
}

TEST(OverviewInputs, StayWithinTheirBudgetAndEvictUsedChildrenFirst) {
  OverviewInputs inputs(100);
  for (const char* name : {"a", "b", "c"}) inputs.keep(name, child_of_bytes(30));
  const auto used = inputs.find("b");
  inputs.keep("d", child_of_bytes(30));
  EXPECT_EQ(inputs.find("b"), nullptr);
  EXPECT_EQ(used->source.rgba.size(), 30u) << "a caller keeps the child that it found";
  EXPECT_NE(inputs.find("a"), nullptr);
  EXPECT_LE(inputs.bytes(), 100u);
  inputs.keep("e", child_of_bytes(101));
  EXPECT_EQ(inputs.find("e"), nullptr) << "larger than the budget";
  EXPECT_NE(inputs.find("c"), nullptr);
}

}  // namespace
}  // namespace gigabake
