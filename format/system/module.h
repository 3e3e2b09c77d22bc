/// Modules: parts of gigabake in shared libraries of their own, because what they link would cost every start of every
/// rank its time and memory.
#pragma once

#include <string>

namespace gigabake {

/// The function `symbol` of the module `name` ("gdal"), which is loaded when it is first asked for and then stays.
/// The system's loader looks for it where the program's run path says: beside the program in a build, in lib/gigabake
/// where it is installed, then in LD_LIBRARY_PATH.
/// Errors  InputError: there is none of this version, or it lacks a library; with the system's reason.
void* module_function(const std::string& name, const char* symbol);

}  // namespace gigabake
