/// Copies of bricks from one level to another.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/body/cell.h"

namespace gigabake {

/// Appends bricks [begin, end) of a level.
/// Range   Keys of `from` there are greater than the keys in `to`. Both levels have the same channels.
void append_bricks(const kernels::Level& from, std::size_t begin, std::size_t end, kernels::Level& to);

/// Appends one voxel to the arrays of `to`, without a brick.
void append_voxel(const kernels::Level& from, std::size_t voxel, kernels::Level& to);

/// Returns the index of the first brick whose key is at least `key`.
std::size_t lower_brick(const kernels::Level& level, std::uint64_t key);

/// Returns the index of the brick with a key; the number of bricks if there is none.
std::size_t find_brick(const kernels::Level& level, std::uint64_t key);

/// Tests whether two bricks have the same voxels and values.
bool are_equal_bricks(const kernels::Level& a, std::size_t brick_a, const kernels::Level& b, std::size_t brick_b);

}  // namespace gigabake
