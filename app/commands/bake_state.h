/// The state of a bake for the browser's page.
#pragma once

#include <string>

namespace gigabake::app {

/// Returns JSON for the browser's page: state, status line, completed fraction, number of cells by state; "null" if
/// `out` has no readable status.
std::string bake_status_json(const std::string& out);

}  // namespace gigabake::app
