#include "format/system/module.h"

#include <dlfcn.h>

#include "core/base/error.h"

namespace gigabake {

void* module_function(const std::string& name, const char* symbol) {
  const std::string file = "gigabake-" + name + "-" GIGABAKE_VERSION ".so";
  void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const function = module != nullptr ? ::dlsym(module, symbol) : nullptr;
  if (function == nullptr) {
    const char* const reason = ::dlerror();
    throw InputError(file, "",
                     std::string("this part of gigabake cannot be loaded; install it again: ") +
                         (reason != nullptr ? reason : symbol));
  }
  return function;
}

}  // namespace gigabake
