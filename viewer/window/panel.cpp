#include "viewer/window/panel.h"

#include <cmath>
#include <fmt/format.h>
#include <imgui.h>

#include "core/base/pluralize.h"
#include "viewer/live/viewer_input_json.h"

namespace gigabake {
namespace {

void line(const std::string& text) { ImGui::TextUnformatted(text.data(), text.data() + text.size()); }

std::string megabytes(std::uint64_t bytes) {
  return bytes == UINT64_MAX ? "no bound" : fmt::format("{:.0f} MB", double(bytes) / 1e6);
}

void show_numbers(const LiveFrame& f) {
  const FrameStats& s = f.frame.stats;
  line(fmt::format("{} x {}{}", f.frame.picture.width, f.frame.picture.height, s.complete ? ", complete" : ""));
  line(fmt::format("{:.1f} fps, {:.1f} ms a frame", f.frames_per_s, s.total_s * 1e3));
  line(fmt::format("rays {:.1f} ms, uploads {:.1f} ms", s.cast_s * 1e3, s.upload_s * 1e3));
  line(
      fmt::format("{} requested, {} uploaded, {} loading", s.requested, s.uploads, pluralize(s.pages_loading, "page")));
  line(fmt::format("{} of {} used", megabytes(s.bytes_held), megabytes(s.bytes_allowed)));
}

/// Shows a combo box. Returns the chosen value if it differs from `current`.
template <class Enum>
std::optional<Enum> choose(const char* label, Enum current) {
  std::optional<Enum> chosen;
  if (!ImGui::BeginCombo(label, std::string(name_of(current)).c_str())) return chosen;
  for (const Enum value : values_of<Enum>())
    if (ImGui::Selectable(std::string(name_of(value)).c_str(), value == current) && value != current) chosen = value;
  ImGui::EndCombo();
  return chosen;
}

/// Shows controls for the sun's direction, and for the day and hour from which the direction can be computed.
void show_sun(const ViewerState& state, ViewerInput& out, SunClock& clock) {
  float azimuth = float(state.full_view.sun.azimuth_deg), elevation = float(state.full_view.sun.elevation_deg);
  if (azimuth < 0) azimuth += 360;
  const bool turned = ImGui::SliderFloat("sun from north", &azimuth, 0, 360, "%.1f deg");
  const bool raised = ImGui::SliderFloat("sun above horizon", &elevation, -20, 90, "%.1f deg");
  if (turned || raised) out.sun = {azimuth, elevation};
  if (!state.has_place) return;
  const bool other_day = ImGui::SliderInt("day of the year", &clock.day, 1, 365);
  const bool other_hour = ImGui::SliderFloat("clock, hours UTC", &clock.hour, 0, 24, "%.2f");
  if (other_day || other_hour) out.time = julian_day("2026-01-01T00:00Z") + (clock.day - 1) + double(clock.hour) / 24;
}

void show_choices(const ViewerState& state, ViewerInput& out, SunClock& clock) {
  if (const auto mode = choose("mode (M)", state.full_view.mode)) out.mode = mode;
  if (const auto style = choose("move (O)", state.style)) out.style = style;
  float pixel_error = float(state.full_view.camera.pixel_error), upload_ms = float(state.upload_s * 1e3);
  if (ImGui::SliderFloat("pixel error (+ -)", &pixel_error, 0.25f, 64, "%.2f", ImGuiSliderFlags_Logarithmic))
    out.pixel_error = pixel_error;
  if (ImGui::SliderFloat("upload ms", &upload_ms, 0.1f, 200, "%.1f")) out.upload_s = upload_ms / 1e3;
  if (const auto shadows = choose("shadows", state.full_view.shadows)) out.shadows = shadows;
  if (const auto blend = choose("level blend", state.full_view.level_blend)) out.level_blend = blend;
  show_sun(state, out, clock);
  line(fmt::format("speed {:.1f} m/s (wheel in flight)", state.speed_m_per_s));
}

}  // namespace

std::string loading_text(const ViewerState& state, const LiveFrame* frame) {
  if (state.resting || !state.problem.empty()) return "";
  if (!state.has_scene || !frame) return "loading";
  if (frame->frame.stats.complete) return "";
  return state.drawn > 0 ? fmt::format("loading, {:.0f} % rendered", std::floor(100 * state.drawn)) : "loading";
}

PanelAnswer show_panel(const ViewerState& state, const LiveFrame* frame, bool recording, const std::string& said,
                       const std::string& place, SunClock& clock) {
  PanelAnswer out;
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_Once);
  ImGui::Begin("gigabake (F1)", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  const std::string loading = loading_text(state, frame);
  line(loading.empty() ? "complete" : loading);
  if (frame) show_numbers(*frame);
  if (state.has_scene) {
    show_choices(state, out.input, clock);
    out.input.home = ImGui::Button("Home (H)");
    ImGui::SameLine();
    out.save_picture = ImGui::Button("Save image (P)");
    ImGui::SameLine();
    out.record = ImGui::Button(recording ? "Stop recording (R)" : "Record path (R)");
  }
  if (state.problems > 0) line(pluralize(state.problems, "shard is", "shards are") + " missing or damaged");
  if (!state.problem.empty()) line(state.problem);
  if (!place.empty()) line(place);
  if (!said.empty()) line(said);
  line("? shows the keys");
  ImGui::End();
  return out;
}

void show_keys() {
  static constexpr const char* keys[][2] = {{"left button", "turn; Shift: move across the view"},
                                            {"right button", "move across the view"},
                                            {"wheel", "nearer or farther; flight: speed"},
                                            {"W A S D Q E", "move; down and up; Shift: slower"},
                                            {"arrows", "turn"},
                                            {"O", "orbit or fly"},
                                            {"M", "next mode"},
                                            {"+ -", "coarser, finer"},
                                            {"H", "the whole scene"},
                                            {"C", "measure: press it at each end"},
                                            {"1 to 9", "go to a saved view; Shift: save it"},
                                            {"P", "save the image"},
                                            {"R", "record a path"},
                                            {"F1", "the panel"},
                                            {"F2", "the brush, if the window may edit"},
                                            {"Enter", "apply the placed brush"},
                                            {"?", "these keys"},
                                            {"Esc", "close"}};
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x - 8, 8}, ImGuiCond_Appearing, {1, 0});
  ImGui::Begin("keys (?)", nullptr, ImGuiWindowFlags_AlwaysAutoResize);
  for (const auto& [key, meaning] : keys) line(fmt::format("{:<12} {}", key, meaning));
  ImGui::End();
}

}  // namespace gigabake
