/// Modules: parts of gigabake in separate shared libraries, because linking their dependencies would cost every rank
/// start-up time and memory.
#pragma once

#include <string>

namespace gigabake {

/// Returns the function `symbol` of the module `name` ("gdal"). Loads the module at the first call and never unloads
/// it. The loader searches the program's run path (next to the program in a build, lib/gigabake if installed), then
/// LD_LIBRARY_PATH.
/// Errors  InputError with the system's reason if there is no module of this version, or one of its libraries is
///         missing.
void* module_function(const std::string& name, const char* symbol);

}  // namespace gigabake
