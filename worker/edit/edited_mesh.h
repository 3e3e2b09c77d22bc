/// Edits of a source, applied to the triangles of one instance of a mesh.
///
/// Exact   Triangles that no border crosses keep all bits, or are dropped, or only their heights change. Other
///         triangles are cut in the polygon's plane; attributes of new corners are interpolated and rounded once. A
///         triangle's pieces depend only on the triangle and the edits, not on the cell.
#pragma once

#include <memory>

#include "core/base/memory_limit.h"
#include "format/edit/source_edits_in_scene.h"
#include "format/source/mesh.h"

namespace gigabake {

/// Applies edits in their order. Returns `mesh` if no edit changes it, and null if nothing remains.
/// Errors  InputError if the claim exceeds the memory limit.
std::shared_ptr<const Primitive> edited_mesh(std::shared_ptr<const Primitive> mesh,
                                             const Affine<Scene, Local>& scene_from_local,
                                             const SourceEditsInScene& edits, MemoryClaim& memory);

}  // namespace gigabake
