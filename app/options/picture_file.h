/// Image files; the file name's suffix selects the format.
#pragma once

#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake::app {

enum class PictureFormat { png, jpeg, exr };

/// Returns the format for the suffix, in any case: .png, .jpg or .jpeg, .exr.
/// Errors  UsageError: another suffix, or none; .exr in a build without OpenEXR.
PictureFormat picture_format(const char* option, const std::string& name);

/// Writes an image. An EXR file contains light and depth.
/// Errors  InputError, naming the file and the system's reason; no partial file remains.
void write_picture(const std::string& name, const Picture& picture, double voxel_size_m);

}  // namespace gigabake::app
