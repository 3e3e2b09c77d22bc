/// What the libraries call a field, the command line calls an option: "`cell_voxels`" becomes "--cell-voxels".
#pragma once

#include <exception>
#include <string>

#include "lattice/error.h"

namespace gigabake::app {

/// Everything that a library says goes through here before a person reads it. JSON for programs keeps the fields.
std::string with_flags(const std::string& message);

/// What to print of an exception: its reason, with options where the libraries have fields.
inline std::string said(const std::exception& error) { return with_flags(reason_of(error)); }

}  // namespace gigabake::app
