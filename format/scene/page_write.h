/// The pages of a scene, written beside its scene.xml, and removed once no scene.xml refers to them.
#pragma once

#include <filesystem>

#include "format/scene/scene_page.h"

namespace gigabake {

/// Pages are named by what they say: one that is there stays as it is. The answer is what scene.xml lists: references,
/// and parents that lie in no block of a page or are of the highest tier.
/// Range   cells of one size. Errors  InputError: a page cannot be written; the scene of before is whole.
ScenePage write_pages(const std::filesystem::path& scene_xml, const SceneDescription& scene, const PageRule& rule);

/// Removes pages that `scene_xml` does not refer to, and what killed writers of pages left. What cannot be removed does
/// no harm. Errors  InputError: the scene cannot be read, and nothing is removed.
void remove_unused_pages(const std::filesystem::path& scene_xml);

}  // namespace gigabake
