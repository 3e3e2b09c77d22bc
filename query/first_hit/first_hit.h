/// First voxel that a ray hits. Voxels are opaque cubes; there is no filtering and no transparency.
///
/// In this file, a cell is the cube of a possible child of a node. The ray traverses these cells from face to face. It
/// descends into the child that contains its current point if that child exists. It crosses empty cells, and ascends
/// when it leaves a node. No step crosses an edge or a corner, so no ray passes between two voxels that share a face or
/// an edge. A point on a face belongs to the cell that the ray enters. If the ray is parallel to the face, the point
/// belongs to the upper cell.
///
/// Space   The tree's cube is mapped to coordinates in [1, 2), so the bits of a float coordinate number the cells. Axes
///         with a negative direction are mirrored, so that the ray's coordinates increase on all axes.
/// Exact   IEEE float and double, fused only where the code calls fma: host and device return the same bits. The
///         traversal deviates from the exact ray by at most 2^-20 of the tree's edge.
/// Source  Laine & Karras 2010, "Efficient Sparse Voxel Octrees"; children by 4×4×4 as in dubiousconst282, "A guide to
///         fast voxel ray tracing using sparse 64-trees".
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/host_device.h"
#include "kernels/body/mask.h"
#include "query/first_hit/first_hit_tree.h"

namespace gigabake::kernels {

inline constexpr int min_stacked = 7, max_stacked = 21;  ///< min and max `scale` of inner levels
inline constexpr int first_hit_stack = (max_stacked - min_stacked) / 2 + 1;
inline constexpr std::uint32_t no_attributes = 0xffffffffu;

struct FirstHitRay {
  double origin[3] = {};    ///< lod-0 voxels of the lattice
  float direction[3] = {};  ///< finite, of length 1; distances are multiples of its length
  float end = INFINITY;     ///< max distance of a hit
};

struct alignas(16) FirstHit {
  std::uint64_t voxel = 0;    ///< x | y << 21 | z << 42, in the tree's voxels from its lowest corner
  float distance = INFINITY;  ///< from the ray's origin to the voxel's surface; 0 inside a voxel
  std::uint32_t attributes_index = no_attributes;  ///< index of the voxel's attributes; no_attributes: no hit
};

GB_HD std::uint32_t bits_of(float v) {
#if defined(__CUDA_ARCH__)
  return __float_as_uint(v);
#else
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return bits;
#endif
}

GB_HD float float_of(std::uint32_t bits) {
#if defined(__CUDA_ARCH__)
  return __uint_as_float(bits);
#else
  float v;
  std::memcpy(&v, &bits, sizeof v);
  return v;
#endif
}

/// Returns the smaller argument.
/// Range   No NaN.
GB_HD float smaller(float a, float b) {
#if defined(__CUDA_ARCH__)
  return fminf(a, b);
#else
  return a < b ? a : b;
#endif
}

GB_HD float larger(float a, float b) {
#if defined(__CUDA_ARCH__)
  return fmaxf(a, b);
#else
  return a > b ? a : b;
#endif
}

/// Returns the index of the highest set bit.
/// Range   v ≠ 0.
GB_HD std::uint32_t top_bit(std::uint32_t v) {
#if defined(__CUDA_ARCH__)
  return std::uint32_t(31 - __clz(int(v)));
#else
  return std::uint32_t(31 - __builtin_clz(v));
#endif
}

/// Returns the low 32 bits of v >> shift.
/// Range   shift < 64.
GB_HD std::uint32_t bits_from(std::uint64_t v, std::uint32_t shift) {
  auto bits = std::uint32_t(v >> shift);
#if defined(__CUDA_ARCH__)
  asm("" : "+r"(bits));  // one instruction; without the asm the compiler would shift a 64-bit mask to the left instead
#endif
  return bits;
}

GB_HD FirstHitNode load_node(const FirstHitTree& tree, std::uint32_t index) {
#if defined(__CUDA_ARCH__)
  const uint4 v = __ldg(reinterpret_cast<const uint4*>(tree.nodes.data) + index);
  return {std::uint64_t(v.y) << 32 | v.x, v.z, 0};
#else
  return tree.nodes.data[index];
#endif
}

/// The stack of one ray, whose slots lie at intervals of `stride`.
template <unsigned stride>
struct FirstHitSlots {
  std::uint32_t* slots;
  GB_HD std::uint32_t& operator()(std::uint32_t scale) const {
    if constexpr (stride % 2 == 0)  // one multiplication, without a preceding halving
      return slots[scale * (stride / 2) - min_stacked * (stride / 2)];
    else
      return slots[(scale - min_stacked) / 2 * stride];
  }
};

/// A ray from its entry into the box of the tree. Axes are mirrored so that no component of the direction is negative.
/// The unit is the edge of the tree's cube.
struct FirstHitLine {
  float origin[3], direction[3], inverse[3];
  float bias[3];         ///< c · inverse + bias: distance to the exit of a cell whose highest float is c
  float enter, leave;    ///< distance from the ray's origin to the box; distance from `origin` to the box's exit
  std::uint32_t mirror;  ///< XOR mask that converts child numbers on the mirrored axes
};

/// Computes the ray's segment inside the box. Returns false if the ray misses the box.
GB_HD bool enter_box(const FirstHitTree& tree, const FirstHitRay& ray, float start, FirstHitLine& line) {
  constexpr float min_direction = 0x1p-60f;
  double at[3], enter = start * tree.per_edge, leave = ray.end * tree.per_edge;
  line.mirror = 0;
  for (int a = 0; a < 3; ++a) {
    const bool falls = ray.direction[a] < 0;
    line.mirror |= falls ? 3u << 2 * a : 0;
    line.direction[a] = larger(std::fabs(ray.direction[a]), min_direction);
    line.inverse[a] = 1 / line.direction[a];
    // One Newton step refines the inverse, because an origin may be far away.
    const double d = line.direction[a], rough = line.inverse[a];
    const double inverse = std::fma(rough, std::fma(-d, rough, 1.0), rough);
    const double away = (ray.origin[a] - tree.centre[a]) * tree.per_edge;
    at[a] = falls ? -away : away;
    const double low = (-tree.half[a] - at[a]) * inverse, high = (tree.half[a] - at[a]) * inverse;
    enter = low > enter ? low : enter;
    leave = high < leave ? high : leave;
  }
  if (!(enter <= leave)) return false;
  for (int a = 0; a < 3; ++a) {
    const float p = float(std::fma(double(line.direction[a]), enter, at[a]) + 1.5);
    line.origin[a] = smaller(larger(p, 1), 0x1.fffffep0f);
    line.bias[a] = (0x1p-23f - line.origin[a]) * line.inverse[a];
  }
  line.enter = float(enter);
  line.leave = float(leave - enter);
  return true;
}

/// The state of a traversal. The ray is at point p of the line, at distance t from the line's origin. The point lies in
/// a cell of `node`. Bits `scale` and `scale` + 1 of p number this cell on each axis.
struct FirstHitTraversal {
  FirstHitLine line;
  std::uint32_t p[3];
  float t;
  std::uint32_t scale;  ///< odd
  std::uint32_t index;  ///< of the node
  FirstHitNode node;
};

enum class FirstHitState : std::int32_t { walking, met, missed };

/// Starts a traversal. Returns false if the ray cannot hit a voxel. `start` is a lower bound of the hit's distance.
GB_HD bool begin_traversal(const FirstHitTree& tree, const FirstHitRay& ray, float start, FirstHitTraversal& walk) {
  if (tree.nodes.empty() || !enter_box(tree, ray, start, walk.line)) return false;
  for (int a = 0; a < 3; ++a) walk.p[a] = bits_of(walk.line.origin[a]);
  walk.t = 0;
  walk.scale = max_stacked;
  walk.index = 0;
  walk.node = load_node(tree, 0);
  return true;
}

/// Returns the number of the node's child that contains p.
GB_HD std::uint32_t child_at(const FirstHitTraversal& w) {
  return (((w.p[0] >> w.scale & 3) ^ w.line.mirror) ^ (w.p[1] >> (w.scale - 2) & 12)) ^ (w.p[2] >> (w.scale - 4) & 48);
}

/// Crosses the empty cell that contains p, or the 2×2×2 cells around it if all of them are empty. Returns a mask whose
/// highest set bit is the highest bit in which the positions before and behind the crossed face differ.
GB_HD std::uint32_t cross_cell(FirstHitTraversal& w, std::uint32_t child) {
  const bool all_empty = (bits_from(w.node.mask, child & 42) & 0x00330033u) == 0;
  const std::uint32_t inside = (1u << (w.scale + (all_empty ? 1 : 0))) - 1;
  std::uint32_t last[3], p[3];  // `last` is the highest point of the crossed cells
  float ends[3];
  for (int a = 0; a < 3; ++a) {
    p[a] = w.p[a];
    last[a] = p[a] | inside;
    ends[a] = std::fma(float_of(last[a]), w.line.inverse[a], w.line.bias[a]);
  }
  w.t = smaller(smaller(ends[0], ends[1]), ends[2]);
  const bool x = ends[0] == w.t, y = !x && ends[1] == w.t, z = !x && !y;
  if (x) p[0] = last[0] + 1;
  if (y) p[1] = last[1] + 1;
  if (z) p[2] = last[2] + 1;
  for (int a = 0; a < 3; ++a) {
    const float along = std::fma(w.line.direction[a], w.t, w.line.origin[a]);
    w.p[a] = bits_of(larger(smaller(along, float_of(last[a])), float_of(p[a])));
  }
  return (p[0] ^ last[0]) | (p[1] ^ last[1]) | (p[2] ^ last[2]);
}

/// Descends if the child exists, then crosses the next cell if it is empty. One call does both steps to reduce
/// divergence between the rays of a warp. The functor `stack` must return a reference to a std::uint32_t of this ray
/// for each odd scale from min_stacked to max_stacked.
template <class Stack>
GB_HD FirstHitState advance(const FirstHitTree& tree, FirstHitTraversal& w, Stack stack) {
  const std::uint32_t first = child_at(w);
  const bool exists = (bits_from(w.node.mask, first) & 1) != 0;
  if (exists && w.scale == std::uint32_t(23 - tree.bits))
    return w.t > w.line.leave ? FirstHitState::missed : FirstHitState::met;
  if (exists) {
    stack(w.scale) = w.index;
    w.index = w.node.end - std::uint32_t(bit_count(w.node.mask >> first));
    w.scale -= 2;
    w.node = load_node(tree, w.index);
  }
  const std::uint32_t child = child_at(w);
  if ((bits_from(w.node.mask, child) & 1) == 0) {
    const std::uint32_t top = top_bit(cross_cell(w, child));
    if (top < w.scale + 2) return FirstHitState::walking;
    if (top > 22 || w.t > w.line.leave) return FirstHitState::missed;
    w.scale = (top - 1) | 1;
    w.index = stack(w.scale);
    w.node = load_node(tree, w.index);
  }
  return FirstHitState::walking;
}

/// Returns the hit of a traversal in state `met`.
GB_HD FirstHit met(const FirstHitTree& tree, const FirstHitTraversal& w) {
  FirstHit hit;
  const std::uint32_t maximum = (1u << tree.bits) - 1;
  for (int a = 0; a < 3; ++a) {
    const std::uint32_t v = w.p[a] >> w.scale & maximum;
    hit.voxel |= std::uint64_t((w.line.mirror >> 2 * a & 1) != 0 ? maximum - v : v) << 21 * a;
  }
  hit.distance = (w.line.enter + w.t) * tree.edge;
  hit.attributes_index = w.node.end - std::uint32_t(bit_count(w.node.mask >> child_at(w)));
  return hit;
}

template <class Stack>
GB_HD FirstHit first_hit(const FirstHitTree& tree, const FirstHitRay& ray, float start, Stack stack) {
  FirstHitTraversal walk;
  if (!begin_traversal(tree, ray, start, walk)) return {};
  FirstHitState state = FirstHitState::walking;
  while (state == FirstHitState::walking) state = advance(tree, walk, stack);
  return state == FirstHitState::met ? met(tree, walk) : FirstHit{};
}

}  // namespace gigabake::kernels
