/// A node of the pools: the tile of its children and its brick, or why they are not here; and the one word it takes.
#pragma once

#include <cstdint>

#include "lattice/host_device.h"

namespace gigabake::kernels {

/// A reference to a tile or a slot, or why there is none.
inline constexpr std::uint32_t empty_ref = 0xffffffffu;   ///< there is nothing: the field is zero
inline constexpr std::uint32_t absent_ref = 0xfffffffeu;  ///< not here yet
inline constexpr std::uint32_t lost_ref = 0xfffffffdu;    ///< will never be here: coarser bricks stand for it
GB_HD bool is_here(std::uint32_t ref) { return ref < lost_ref; }

/// Eight of them, x | y<<1 | z<<2, are a tile. Node n of tile t is node 8t + n. brick = empty_ref: so is all below.
struct CastNode {
  std::uint32_t children = absent_ref;  ///< tile
  std::uint32_t brick = absent_ref;     ///< slot
};

/// Few nodes have both, so a node takes one word. It is the tile of its children, where they are here and its brick is
/// not empty; the brick then stands beside that tile. Else bit 31 is set, bits 29 and 30 say why there are no children,
/// and the others are the slot. What is no slot or tile is told by the lowest bits of its reference.
using NodeWord = std::uint32_t;
inline constexpr std::uint32_t leaf_bit = 1u << 31;
inline constexpr int slot_bits = 29;
inline constexpr std::uint32_t slot_mask = (1u << slot_bits) - 1;

inline constexpr NodeWord empty_node = ~NodeWord(0);

GB_HD bool leads_on(NodeWord word) { return (word & leaf_bit) == 0; }

/// Range  tiles below 2^31, slots below 2^29 - 3.
GB_HD NodeWord pack_node(const CastNode& node) {
  if (node.brick == empty_ref) return empty_node;
  if (is_here(node.children)) return node.children;
  return leaf_bit | (node.children & 3) << slot_bits | (node.brick & slot_mask);
}

/// Of a word that does not lead on. Exact  all but the children of an empty node.
GB_HD CastNode unpack_leaf(NodeWord word) {
  const std::uint32_t slot = word & slot_mask;
  return {~3u | word >> slot_bits, slot < (lost_ref & slot_mask) ? slot : slot | ~slot_mask};
}

}  // namespace gigabake::kernels
