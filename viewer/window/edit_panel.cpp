#include "viewer/window/edit_panel.h"

#include <cmath>
#include <imgui.h>
#include <span>

namespace gigabake {
namespace {

bool choose(const char* label, std::span<const char* const> names, std::size_t& value) {
  int chosen = int(value);
  if (!ImGui::Combo(label, &chosen, names.data(), int(names.size()))) return false;
  value = std::size_t(chosen);
  return true;
}

bool drag_metres(const char* label, double& metres) {
  constexpr double slowest = 0.001, fastest = 100'000;
  const float speed = float(metres / 50);
  return ImGui::DragScalar(label, ImGuiDataType_Double, &metres, speed, &slowest, &fastest, "%.3f m");
}

bool choose_colour(std::array<std::uint8_t, 3>& rgb) {
  float shares[3];
  for (std::size_t c = 0; c < 3; ++c) shares[c] = float(rgb[c]) / 255;
  if (!ImGui::ColorEdit3("colour", shares)) return false;
  for (std::size_t c = 0; c < 3; ++c) rgb[c] = std::uint8_t(std::lround(shares[c] * 255));
  return true;
}

}  // namespace

EditPanelAnswer show_edit_panel(EditBrush& brush, bool is_placed, bool is_busy) {
  EditPanelAnswer out;
  ImGui::SetNextWindowPos({8, ImGui::GetIO().DisplaySize.y - 8}, ImGuiCond_Once, {0, 1});
  ImGui::Begin("edit (F2)", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  const bool has_other_type = choose("effect", brush_types, brush.type);
  const bool has_other_shape = choose("shape", brush_shapes, brush.shape);
  const bool is_wider = drag_metres("radius", brush.radius_m), is_higher = drag_metres("height", brush.height_m);
  const bool is_recoloured = choose_colour(brush.rgb);
  out.is_changed = has_other_type || has_other_shape || is_wider || is_higher || is_recoloured;
  ImGui::TextUnformatted(is_busy     ? "the scene is being changed"
                         : is_placed ? "Apply changes the scene as shown"
                                     : "click a surface to place the shape");
  ImGui::BeginDisabled(is_busy);
  ImGui::BeginDisabled(!is_placed);
  out.apply = ImGui::Button("Apply");
  ImGui::SameLine();
  out.cancel = ImGui::Button("Cancel");
  ImGui::EndDisabled();
  ImGui::SameLine();
  out.undo = ImGui::Button("Undo last edit");
  ImGui::EndDisabled();
  ImGui::End();
  return out;
}

}  // namespace gigabake
