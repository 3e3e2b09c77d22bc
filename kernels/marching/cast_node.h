/// A node of the pools and its packing into a word. A node refers to the tile of its children and to its brick, or
/// gives the reasons why they are missing.
#pragma once

#include <cstdint>

#include "core/base/host_device.h"

namespace gigabake::kernels {

/// The values of a reference to a tile or a slot that give the reason why there is no tile or slot.
inline constexpr std::uint32_t empty_ref = 0xffffffffu;         ///< the subtree is empty: the field is zero
inline constexpr std::uint32_t not_resident_ref = 0xfffffffeu;  ///< not resident yet
inline constexpr std::uint32_t lost_ref = 0xfffffffdu;          ///< will never be resident: coarser bricks replace it
GB_HD bool is_resident(std::uint32_t ref) { return ref < lost_ref; }

/// A node. Eight siblings, in the order x | y<<1 | z<<2, form a tile; node n of tile t has the index 8t + n. If brick
/// is empty_ref, all descendants are empty too.
struct CastNode {
  std::uint32_t children = not_resident_ref;  ///< tile
  std::uint32_t brick = not_resident_ref;     ///< slot
};

/// A node packed into one word. If the children are resident and the brick is not empty, the word is the tile of the
/// children. The reference to the brick is then stored per tile, in CastScene::parent_bricks. Otherwise bit 31 is set
/// and bits 29 and 30 hold the lowest two bits of `children`. Bits 0 to 28 then hold the lowest bits of `brick`, which
/// distinguish the reasons empty_ref, not_resident_ref and lost_ref.
using NodeWord = std::uint32_t;
inline constexpr std::uint32_t leaf_bit = 1u << 31;
inline constexpr int slot_bits = 29;
inline constexpr std::uint32_t slot_mask = (1u << slot_bits) - 1;

inline constexpr NodeWord empty_node = ~NodeWord(0);

GB_HD bool leads_on(NodeWord word) { return (word & leaf_bit) == 0; }

/// Packs a node.
/// Range   Tiles are below 2^31, slots below 2^29 - 3.
GB_HD NodeWord pack_node(const CastNode& node) {
  if (node.brick == empty_ref) return empty_node;
  if (is_resident(node.children)) return node.children;
  return leaf_bit | (node.children & 3) << slot_bits | (node.brick & slot_mask);
}

/// Unpacks a word for which leads_on() is false.
/// Exact   Returns the packed node, except that the children of an empty node become empty_ref.
GB_HD CastNode unpack_leaf(NodeWord word) {
  const std::uint32_t slot = word & slot_mask;
  return {~3u | word >> slot_bits, slot < (lost_ref & slot_mask) ? slot : slot | ~slot_mask};
}

}  // namespace gigabake::kernels
