/// The browser's page as it stands in viewer/web/, built into the program.
#pragma once

#include <string_view>

namespace gigabake {

extern const std::string_view web_page, web_script, web_style;

}  // namespace gigabake
