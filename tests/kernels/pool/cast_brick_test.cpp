#include "kernels/pool/cast_brick.h"

#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/octree/plane.h"

namespace gigabake::kernels {
namespace {

constexpr std::uint64_t seed = 20261123;

bool are_same(const CastVoxel& a, const CastVoxel& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Compares the functions that read parts of a packed voxel with the voxel.
void expect_parts(const PackedVoxel& packed, const CastVoxel& voxel) {
  for (int a = 0; a < 3; ++a) {
    ASSERT_EQ(coverage_along(packed, a), voxel.c[3 + a]);
    ASSERT_EQ(radiance_channel(packed, a), voxel.c[a]);
    ASSERT_EQ(std::int8_t(packed_normal(packed) >> 8 * a & 255), voxel.normal[a]);
  }
  ASSERT_EQ(packed_normal(packed) >> 24, 0u);
  ASSERT_EQ(257 * coverage_sum(packed), voxel.c[3] + voxel.c[4] + voxel.c[5]);
  ASSERT_EQ(plane_of(packed), voxel.plane);
}

TEST(PackedVoxel, IsTheVoxelWithoutLoss) {
  std::mt19937_64 random(seed);
  for (int x = -127; x <= 127; ++x)
    for (int y = -127; y <= 127; ++y) {
      const std::int8_t stored[2] = {std::int8_t(x), std::int8_t(y)};
      CastVoxel voxel;
      for (int k = 0; k < 3; ++k) voxel.c[k] = std::uint16_t(random());
      for (int k = 3; k < 6; ++k) voxel.c[k] = std::uint16_t(257 * (random() % 256));
      voxel.plane = std::uint8_t(random() % (clear_plane + 1));
      const bool has_normal = random() % 8 != 0;
      for (int a = 0; a < 3 && has_normal; ++a) voxel.normal[a] = std::int8_t(octahedron_point(stored).c[a]);
      ASSERT_TRUE(are_same(unpack_voxel(pack_voxel(voxel)), voxel)) << x << " " << y;
      expect_parts(pack_voxel(voxel), voxel);
    }
}

TEST(LayerWindow, HasTheFourVoxelsThatAreReadWithoutIt) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 300; ++i) {
    const std::uint32_t bits[3] = {std::uint32_t(random()), std::uint32_t(random()),
                                   std::uint32_t(random()) & last_places_mask};
    const CastLayer layer = make_layer(bits, std::uint32_t(random() % 1000));
    const PackedVoxel parts[2] = {{}, {{layer.bits[0], layer.bits[1], layer.bits[2]}}};
    const BrickView view{1u << 3, 1, parts};
    for (int y = 0; y < brick_edge; ++y)
      for (int x = 0; x < brick_edge; ++x) {
        const int at = x + slot_edge * y;
        ASSERT_EQ(load_two_by_two(view, 3, at), window_of(layer, at).two_by_two()) << "seed " << seed << ", " << at;
        ASSERT_EQ(load_two_by_two(view, 4, at), 0u);
      }
  }
}

TEST(LayerWindow, KnowsWhichVoxelsAreThereAndWhere) {
  std::mt19937_64 random(seed);
  constexpr int places = slot_edge * slot_edge;
  for (int i = 0; i < 300; ++i) {
    const std::uint64_t one_in = 1 + random() % 8;
    std::uint32_t bits[3] = {0, 0, 0};
    const auto first = std::uint32_t(random() % 1000);
    std::vector<int> stands(places + 16, -1);
    int next = int(first);
    for (int at = 0; at < places; ++at) {
      if (random() % one_in != 0) continue;
      bits[at / 32] |= 1u << at % 32;
      stands[std::size_t(at)] = next++;
    }
    const CastLayer layer = make_layer(bits, first);
    for (int at = 0; at < places; ++at) {
      const LayerWindow window = window_of(layer, at);
      for (int k = 0; k <= slot_edge + 1; ++k) {
        const int expected = stands[std::size_t(at + k)];
        ASSERT_EQ(window.has(k), expected >= 0) << "seed " << seed << ", place " << at << " + " << k;
        if (expected >= 0 && k == (window.has(0) ? 0 : 1)) {
          ASSERT_EQ(int(window.first), expected) << "seed " << seed << ", place " << at;
        }
        if (expected >= 0 && k == slot_edge + (window.has(slot_edge) ? 0 : 1)) {
          ASSERT_EQ(int(window.second), expected) << "seed " << seed << ", place " << at;
        }
      }
    }
  }
}

}  // namespace
}  // namespace gigabake::kernels
