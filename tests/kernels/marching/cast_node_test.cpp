#include "kernels/marching/cast_node.h"

#include <gtest/gtest.h>

namespace gigabake::kernels {
namespace {

constexpr std::uint32_t references[] = {empty_ref, not_resident_ref, lost_ref};

TEST(NodeWord, KnowsTheChildrenAndWhyTheyAreNotHere) {
  for (const std::uint32_t tile : {0u, 1u, 77u, leaf_bit - 1})
    for (const std::uint32_t brick : {0u, 12u, not_resident_ref, lost_ref}) {
      ASSERT_TRUE(leads_on(pack_node({tile, brick})));
      EXPECT_EQ(pack_node({tile, brick}), tile);
    }
  for (const std::uint32_t children : references)
    for (const std::uint32_t brick : {0u, 12u, (lost_ref & slot_mask) - 1, not_resident_ref, lost_ref}) {
      const NodeWord word = pack_node({children, brick});
      ASSERT_FALSE(leads_on(word));
      EXPECT_EQ(unpack_leaf(word).children, children);
      EXPECT_EQ(unpack_leaf(word).brick, brick);
    }
}

TEST(NodeWord, OfAnEmptyNodeLeadsNowhere) {
  for (const std::uint32_t children : {0u, 77u, empty_ref, not_resident_ref, lost_ref}) {
    const NodeWord word = pack_node({children, empty_ref});
    ASSERT_FALSE(leads_on(word));
    EXPECT_EQ(unpack_leaf(word).brick, empty_ref);
  }
}

}  // namespace
}  // namespace gigabake::kernels
