/// The panel in a window: statistics of the last frame, and settings.
#pragma once

#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

struct PanelAnswer {
  ViewerInput input;
  bool save_picture = false, record = false;
};

/// Day and hour (UTC) of the sun's clock in the panel; the year is 2026.
struct SunClock {
  int day = 172;  ///< 1 … 365; initially midsummer
  float hour = 12;
};

/// Returns the progress as text, such as "loading, 45 % rendered"; empty if the frame is final. frame may be nullptr.
std::string loading_text(const ViewerState& state, const LiveFrame* frame);

/// Shows the panel; call it between ImGui::NewFrame() and ImGui::Render(). frame may be nullptr. `said` is the last
/// message about a saved file or an error. `place` describes the scene point under the mouse. Empty texts are omitted.
PanelAnswer show_panel(const ViewerState& state, const LiveFrame* frame, bool recording, const std::string& said,
                       const std::string& place, SunClock& clock);

/// Shows the function of each key and mouse button. Call it between ImGui::NewFrame() and ImGui::Render().
void show_keys();

}  // namespace gigabake
