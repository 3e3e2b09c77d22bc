/// Coordinates of edits in JSON.
#pragma once

#include <vector>

#include "format/edit/edit.h"
#include "format/system/json/json_members.h"

namespace gigabake {

/// Max absolute metres of a coordinate, so that it fits the lattice of any voxel size above a nanometre.
inline constexpr double max_edit_metres = 1e9;

/// Names of the members that hold the coordinates of a shape, in metres and in degrees.
struct FrameKeys {
  const char* metres;
  const char* degrees;

  const char* in(EditFrame frame) const { return frame == EditFrame::degrees ? degrees : metres; }
};

inline constexpr FrameKeys ring_keys{"rings_m", "rings_lon_lat"};

/// Returns the frame of the only given member of the two.
/// Errors  InputError: both or neither are given.
EditFrame frame_of(const JsonMembers& shape, const FrameKeys& keys);

/// Returns the rings in the member `rings_m` or `rings_lon_lat`, and sets their frame.
/// Errors  InputError(file, key): no rings, a ring with fewer than three positions, rings that cross themselves or each
///         other, a hole outside, or a coordinate out of range.
std::vector<PrismShape::Ring> rings_of(const JsonMembers& shape, EditFrame& frame);

}  // namespace gigabake
