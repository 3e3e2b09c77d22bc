/// A picture as a JPEG file, for streams.
#pragma once

#include <string>

#include "viewer/pictures/picture.h"

namespace gigabake {

/// Alpha is left out. quality: 1 to 100; colour is halved in size below 90.
/// Exact  Equal pictures give equal bytes. Errors  std::runtime_error: libjpeg's message.
std::string encode_jpeg(const Picture& picture, int quality);

}  // namespace gigabake
