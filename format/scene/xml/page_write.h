/// Writing of a scene's pages next to its scene.xml, and removal of pages to which scene.xml does not refer.
#pragma once

#include <filesystem>
#include <string>
#include <unordered_set>

#include "format/scene/scene_page.h"

namespace gigabake {

/// Writes the pages and returns the content of scene.xml: page references and overviews. The result has the overviews
/// that lie in no page's block or are of the highest overview level. The name of a page depends on its content, so a
/// page that exists is not written again.
/// Range   All cells have the same size.
/// Errors  InputError: a page cannot be written; the previous scene remains valid.
ScenePage write_pages(const std::filesystem::path& scene_xml, const SceneDescription& scene, const PageRule& rule);

/// Names of the files of pages.
using PageNames = std::unordered_set<std::string>;

/// Returns the names of the pages to which a scene refers.
/// Errors  InputError: the scene cannot be read.
PageNames page_names(const std::filesystem::path& scene_xml);

/// Removes pages to which `scene_xml` does not refer and that are not in `kept`, and temporary files of writers that
/// were killed. Ignores files that cannot be removed; they do no harm.
/// Errors  InputError: the scene cannot be read; nothing is removed then.
void remove_unused_pages(const std::filesystem::path& scene_xml, const PageNames& kept = {});

}  // namespace gigabake
