/// The options of `edit` that state an edit.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/math/frames.h"
#include "format/edit/edit.h"

namespace gigabake::app {

struct EditOptions {
  std::string carve, fill, paint, from;
  std::string rgb, alpha;
  bool degrees = false;
  std::optional<UpAxis> up;

  void add_to(CLI::App& command);
  /// Returns the edits of --from, then that of --carve, --fill or --paint; none without these options.
  /// Errors  UsageError: several of these options, or the option and its expected value; the errors of
  ///         edits_from_json(). InputError: a file cannot be read.
  EditList edits() const;
};

}  // namespace gigabake::app
