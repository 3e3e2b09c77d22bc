/// The chain of fingerprints along the edits of a cell.
#pragma once

#include "core/io/hash128.h"

namespace gigabake {

/// Returns the fingerprint of a cell after one more edit that selects a voxel of it. `fingerprint` is that of the cell
/// before the edit, `edit` is EditsInScene::hash(). Readers of two scenes thus recognize which edits lie between them.
Hash128 edited_fingerprint(const Hash128& fingerprint, const Hash128& edit);

}  // namespace gigabake
