/// The first voxel that a ray meets: a cube, present or not; no filter, no transparency.
///
/// The ray walks from face to face through the cells of the tree: down into the child that holds its point while there
/// is one, across empty cells, up where it leaves a node. No step crosses an edge or a corner, so nothing slips between
/// two voxels that share a face or an edge. A point on a face is in the cell that the ray moves into; where it moves
/// along the face, in the upper one.
///
/// Space   A cell's place is the bits of a float in [1, 2): the tree's cube. Axes along which the ray falls are
///         mirrored, so that it rises along all.
/// Exact   IEEE float and double, fused only where it says so: host and device return the same bits. The walk keeps
///         within 2^-20 of the tree's edge of the exact ray.
/// Source  Laine & Karras 2010, "Efficient Sparse Voxel Octrees"; children by 4×4×4 as in dubiousconst282, "A guide to
///         fast voxel ray tracing using sparse 64-trees".
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kernels/body/mask.h"
#include "kernels/cast/first_hit_tree.h"
#include "lattice/host_device.h"

namespace gigabake::kernels {

inline constexpr int least_stacked = 7, most_stacked = 21;  ///< scales of the inner levels of the deepest tree
inline constexpr int first_hit_stack = (most_stacked - least_stacked) / 2 + 1;
inline constexpr std::uint32_t no_look = 0xffffffffu;

struct FirstHitRay {
  double origin[3] = {};    ///< lod-0 voxels of the lattice
  float direction[3] = {};  ///< finite, of length 1: distances are in units of it
  float end = INFINITY;     ///< the farthest distance that is looked at
};

struct alignas(16) FirstHit {
  std::uint64_t voxel = 0;       ///< x | y << 21 | z << 42, in the tree's voxels from its lowest corner
  float distance = INFINITY;     ///< from the ray's origin to where the voxel begins; 0 inside of one
  std::uint32_t look = no_look;  ///< no_look: nothing was met
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

/// The arguments are numbers.
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

/// v ≠ 0.
GB_HD std::uint32_t top_bit(std::uint32_t v) {
#if defined(__CUDA_ARCH__)
  return std::uint32_t(31 - __clz(int(v)));
#else
  return std::uint32_t(31 - __builtin_clz(v));
#endif
}

/// Bit 0 and on: the bits of v from `shift` on; shift < 64.
GB_HD std::uint32_t bits_from(std::uint64_t v, std::uint32_t shift) {
  auto bits = std::uint32_t(v >> shift);
#if defined(__CUDA_ARCH__)
  asm(""
      : "+r"(bits));  // one instruction; tested as it stands the compiler would shift the test's 64 bits the other way
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

/// Slots that lie `stride` apart.
template <unsigned stride>
struct FirstHitSlots {
  std::uint32_t* slots;
  GB_HD std::uint32_t& operator()(std::uint32_t scale) const {
    if constexpr (stride % 2 == 0)  // a multiplication, where halving would come first
      return slots[scale * (stride / 2) - least_stacked * (stride / 2)];
    else
      return slots[(scale - least_stacked) / 2 * stride];
  }
};

/// A ray from where it enters the box on, every axis rising. Unit: the cube.
struct FirstHitLine {
  float origin[3], direction[3], inverse[3];
  float bias[3];         ///< a cell that ends with the float c is left at c · inverse + bias
  float enter, leave;    ///< the box's ends: from the ray's origin; from `origin`
  std::uint32_t mirror;  ///< what the mirrored axes turn a child's number by
};

/// False where the ray misses the box.
GB_HD bool enter_box(const FirstHitTree& tree, const FirstHitRay& ray, float start, FirstHitLine& line) {
  constexpr float least_direction = 0x1p-60f;
  double at[3], enter = start * tree.per_edge, leave = ray.end * tree.per_edge;
  line.mirror = 0;
  for (int a = 0; a < 3; ++a) {
    const bool falls = ray.direction[a] < 0;
    line.mirror |= falls ? 3u << 2 * a : 0;
    line.direction[a] = larger(std::fabs(ray.direction[a]), least_direction);
    line.inverse[a] = 1 / line.direction[a];
    // Refined: an origin may be far away.
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

/// Where a ray is: at point p of the line, t from the line's origin, in a cell of bit `scale`, a child of the node.
struct FirstHitWalk {
  FirstHitLine line;
  std::uint32_t p[3];
  float t;
  std::uint32_t scale;  ///< odd
  std::uint32_t index;  ///< of the node
  FirstHitNode node;
};

enum class FirstHitState : std::int32_t { walking, met, missed };

/// False where nothing can be met. start: nothing is nearer than this distance.
GB_HD bool begin_walk(const FirstHitTree& tree, const FirstHitRay& ray, float start, FirstHitWalk& walk) {
  if (tree.nodes.empty() || !enter_box(tree, ray, start, walk.line)) return false;
  for (int a = 0; a < 3; ++a) walk.p[a] = bits_of(walk.line.origin[a]);
  walk.t = 0;
  walk.scale = most_stacked;
  walk.index = 0;
  walk.node = load_node(tree, 0);
  return true;
}

/// The number of the node's child that holds p.
GB_HD std::uint32_t child_at(const FirstHitWalk& w) {
  return (((w.p[0] >> w.scale & 3) ^ w.line.mirror) ^ (w.p[1] >> (w.scale - 2) & 12)) ^ (w.p[2] >> (w.scale - 4) & 48);
}

/// Across the empty cell that holds p, or the 2×2×2 cells around it where all of them are empty.
/// Returns the bits in which places before and behind the crossed face differ, and lower ones.
GB_HD std::uint32_t cross_cell(FirstHitWalk& w, std::uint32_t child) {
  const bool all_empty = (bits_from(w.node.mask, child & 42) & 0x00330033u) == 0;
  const std::uint32_t inside = (1u << (w.scale + (all_empty ? 1 : 0))) - 1;
  std::uint32_t last[3], p[3];  // last: the cell's highest point
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

/// Down where the child exists, then on where the next one does not: two moves in one go, so that the rays of a warp
/// seldom wait for each other.
/// stack: stack(scale), an std::uint32_t& of this ray's for each odd scale from least_stacked to most_stacked.
template <class Stack>
GB_HD FirstHitState advance(const FirstHitTree& tree, FirstHitWalk& w, Stack stack) {
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

/// Of a walk that met something.
GB_HD FirstHit met(const FirstHitTree& tree, const FirstHitWalk& w) {
  FirstHit hit;
  const std::uint32_t most = (1u << tree.bits) - 1;
  for (int a = 0; a < 3; ++a) {
    const std::uint32_t v = w.p[a] >> w.scale & most;
    hit.voxel |= std::uint64_t((w.line.mirror >> 2 * a & 1) != 0 ? most - v : v) << 21 * a;
  }
  hit.distance = (w.line.enter + w.t) * tree.edge;
  hit.look = w.node.end - std::uint32_t(bit_count(w.node.mask >> child_at(w)));
  return hit;
}

template <class Stack>
GB_HD FirstHit first_hit(const FirstHitTree& tree, const FirstHitRay& ray, float start, Stack stack) {
  FirstHitWalk walk;
  if (!begin_walk(tree, ray, start, walk)) return {};
  FirstHitState state = FirstHitState::walking;
  while (state == FirstHitState::walking) state = advance(tree, walk, stack);
  return state == FirstHitState::met ? met(tree, walk) : FirstHit{};
}

}  // namespace gigabake::kernels
