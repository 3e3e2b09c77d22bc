/// The options of `edit` that state an edit.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/math/frames.h"
#include "format/edit/scene_edits.h"

namespace gigabake::app {

struct EditOptions {
  std::string carve, fill, paint, from;
  std::string inside, outside, flatten, raise, source;
  std::string rgb, alpha, voxel_class;
  bool degrees = false;
  std::optional<UpAxis> up;

  void add_to(CLI::App& command);
  /// Returns true if no option states an edit.
  bool empty() const;
  /// Returns the edits of --from, then the edit of another option; none without these options.
  /// Errors  UsageError: several of these options, or the option and its expected value; the errors of
  ///         edits_from_json(). InputError: a file cannot be read.
  SceneEditList edits() const;

 private:
  std::optional<Edit> voxel_edit() const;
  std::optional<NamedSourceEdit> source_edit() const;
};

}  // namespace gigabake::app
