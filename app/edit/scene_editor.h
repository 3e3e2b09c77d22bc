/// The editor of the commands `serve` and `view`: runs the command `edit`.
#pragma once

#include <filesystem>
#include <memory>

#include "viewer/live/scene_editor.h"

namespace gigabake::app {

/// Returns an editor of the scene in `folder`. Each edit is a process of `program edit`, with its lock of the scene and
/// its checks. An edit that was begun ends even if this process ends.
/// Range   program: a file of gigabake, such as "/proc/self/exe" in gigabake.
std::shared_ptr<SceneEditor> make_scene_editor(const std::filesystem::path& folder,
                                               const std::filesystem::path& program = "/proc/self/exe");

}  // namespace gigabake::app
