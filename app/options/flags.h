/// Conversion of library field names to command-line options: "`cell_voxels`" becomes "--cell-voxels".
#pragma once

#include <exception>
#include <string>

#include "core/base/error.h"

namespace gigabake::app {

/// Replaces fields by options in a library message that a person reads. JSON for programs keeps the field names.
std::string with_flags(const std::string& message);

/// Returns the reason of an exception, with options in place of library field names.
inline std::string error_text(const std::exception& error) { return with_flags(reason_of(error)); }

}  // namespace gigabake::app
