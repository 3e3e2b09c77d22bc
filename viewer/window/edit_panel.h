/// The panel of the brush in a window.
#pragma once

#include "viewer/live/edit_brush.h"

namespace gigabake {

/// Actions of the user in the panel.
struct EditPanelAnswer {
  bool is_changed = false;  ///< the brush differs, so its preview must be shown again
  bool apply = false, cancel = false, undo = false;
};

/// Shows the panel and changes the brush; call it between ImGui::NewFrame() and ImGui::Render(). `is_placed` is true if
/// the brush has a place, `is_busy` while an edit is being applied.
EditPanelAnswer show_edit_panel(EditBrush& brush, bool is_placed, bool is_busy);

}  // namespace gigabake
