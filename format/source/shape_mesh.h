/// A mesh file as the shape of an edit.
#pragma once

#include <filesystem>
#include <optional>

#include "core/math/frames.h"
#include "format/edit/edit.h"

namespace gigabake {

/// Reads all triangles of a mesh file in its own frame, rotated to z up. `up` is the axis of the file that points up;
/// by default y, as in open_sources().
/// Errors  InputError: the file cannot be read, is not a mesh, or has no triangles.
MeshShape read_shape_mesh(const std::filesystem::path& file, std::optional<UpAxis> up);

}  // namespace gigabake
