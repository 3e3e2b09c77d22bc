/// The files of the browser page in viewer/web/, embedded in the program.
#pragma once

#include <string_view>

namespace gigabake {

extern const std::string_view web_page, web_script, web_bake_script, web_edit_script, web_style;

}  // namespace gigabake
