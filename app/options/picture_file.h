/// Pictures as files whose kind their names say.
#pragma once

#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake::app {

enum class PictureFormat { png, jpeg, exr };

/// By the suffix, in any case: .png, .jpg or .jpeg, .exr. Errors  UsageError: another one, or none.
PictureFormat picture_format(const char* option, const std::string& name);

/// exr: light and depth. Errors  InputError: the file and the system's reason; nothing is left behind.
void write_picture(const std::string& name, const Picture& picture, double voxel_size_m);

}  // namespace gigabake::app
