#include "app/messages/run_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/messages/status_text.h"
#include "format/system/meters/stage_clock.h"

namespace gigabake::app {
namespace {

constexpr double joules_per_watt_hour = 3600;

double run_s(const BakeSummary& s) { return s.scan_s + s.bake_s; }

double per_second(double amount, const BakeSummary& s) { return run_s(s) > 0 ? amount / run_s(s) : 0; }

double share(double seconds, const StageTimes& times) { return times.all_s() > 0 ? seconds / times.all_s() : 0; }

std::optional<double> watt_hours(const BakeSummary& s) {
  if (!s.joules) return std::nullopt;
  return *s.joules / joules_per_watt_hour;
}

std::string stages_text(const StageTimes& times) {
  std::string text = "only busy stage:";
  for (std::size_t s = 0; s < StageTimes::stages; ++s)
    text += fmt::format("{} {} {:.0f} %", s == 0 ? "" : ",", name_of(BakeStage(s)),
                        100 * share(times.exclusive_s[s], times));
  if (const auto bound = times.bound()) text += fmt::format("; the run is bound by {}", name_of(*bound));
  return text;
}

}  // namespace

std::string run_text(const BakeSummary& s) {
  const RunAmounts& a = s.amounts;
  std::string text = fmt::format(
      "{:.3g} km²/s, {:.3g} million triangles/s, {:.3g} million voxels/s, {}/s, {:.2f} CPU seconds",
      per_second(a.square_km, s), 1e-6 * per_second(double(a.triangles), s), 1e-6 * per_second(double(a.voxels), s),
      readable_bytes(std::uint64_t(per_second(double(a.bytes), s))), s.work.cpu_s);
  if (const auto energy = watt_hours(s)) text += fmt::format(", {:.3g} Wh", *energy);
  return text + "; " + stages_text(s.work.stages);
}

void add_run(const BakeSummary& s, nlohmann::ordered_json& report) {
  const RunAmounts& a = s.amounts;
  const StageTimes& times = s.work.stages;
  nlohmann::ordered_json& run = report["run"];
  run = {{"square_km", a.square_km},
         {"triangles", a.triangles},
         {"voxels", a.voxels},
         {"bytes", a.bytes},
         {"seconds", run_s(s)},
         {"square_km_per_s", per_second(a.square_km, s)},
         {"triangles_per_s", per_second(double(a.triangles), s)},
         {"voxels_per_s", per_second(double(a.voxels), s)},
         {"bytes_per_s", per_second(double(a.bytes), s)},
         {"cpu_s", s.work.cpu_s},
         {"watt_hours", nullptr}};
  if (const auto energy = watt_hours(s)) run["watt_hours"] = *energy;
  for (std::size_t stage = 0; stage < StageTimes::stages; ++stage)
    run["exclusive"][std::string(name_of(BakeStage(stage)))] = share(times.exclusive_s[stage], times);
  run["several"] = share(times.several_s, times);
  run["idle"] = share(times.idle_s, times);
  run["bound"] = nullptr;
  if (const auto bound = times.bound()) run["bound"] = name_of(*bound);
  for (std::size_t w = 0; w < s.work.counts.counts.size(); ++w)
    run["work"][std::string(name_of(WorkCounter(w)))] = s.work.counts.counts[w];
}

}  // namespace gigabake::app
