/// The panel in a window: numbers of the last frame, and what can be chosen.
#pragma once

#include <string>

#include "viewer/live/live_scene.h"

namespace gigabake {

struct PanelAnswer {
  Steering steering;
  bool save_picture = false, record = false;
};

/// What the sun's clock shows: a day of 2026 and an hour, UTC.
struct SunClock {
  int day = 172;  ///< 1 … 365; at first midsummer
  float hour = 12;
};

/// What is still to come, as "loading, 45 % drawn"; empty where the frame is all there is to see. frame may be nullptr.
std::string loading_text(const ViewerState& state, const LiveFrame* frame);

/// Between ImGui::NewFrame() and ImGui::Render(). frame may be nullptr; said: the last thing saved or failed; place:
/// what the mouse points at. Lines of texts that are empty are left out.
PanelAnswer show_panel(const ViewerState& state, const LiveFrame* frame, bool recording, const std::string& said,
                       const std::string& place, SunClock& clock);

/// Shows what each key and mouse button does. Between ImGui::NewFrame() and ImGui::Render().
void show_keys();

}  // namespace gigabake
