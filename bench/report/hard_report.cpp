#include "bench/report/hard_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/report/accuracy_verdict.h"
#include "bench/report/leak_report.h"

namespace gigabake::bench {
namespace {

using Json = nlohmann::ordered_json;

/// The numbers that every case may have, one column each.
constexpr const char* columns[] = {"missed",        "extra",  "alpha",    "colour",
                                   "linear colour", "normal", "position", "before the snap"};

/// Returns true for a case with goals. Such cases have a separate table, because they have none of the columns.
bool has_goals(const HardResult& r) {
  return !r.figures.empty() &&
         std::all_of(r.figures.begin(), r.figures.end(), [](const HardFigure& f) { return f.goal.has_value(); });
}

std::string value_of(const HardFigure& f, double value) {
  constexpr double nothing = 1e-9;  // rounding error of an exact zero in double
  if (f.unit != "m") return fmt::format("{:.3g}", std::abs(value) < nothing ? 0 : value);
  return fmt::format("{:.3g}", 1000 * value);  // millimetres
}

std::string cell_of(const HardFigure& f) {
  return fmt::format("{} ≤ {}{}", value_of(f, f.measured), value_of(f, f.bound), f.holds() ? "" : " **fails**");
}

bool has_column(const HardFigure& f) {
  return std::any_of(std::begin(columns), std::end(columns), [&](const char* name) { return f.name == name; });
}

std::string row_of(const std::string& name, const HardResult& r) {
  std::string row = fmt::format("| {} | {} |", name, r.voxels);
  for (const char* column : columns) {
    const auto f =
        std::find_if(r.figures.begin(), r.figures.end(), [&](const HardFigure& x) { return x.name == column; });
    row += f == r.figures.end() ? " |" : fmt::format(" {} |", cell_of(*f));
  }
  std::string more;
  for (const HardFigure& f : r.figures)
    if (!has_column(f))
      more += fmt::format("{}{} {}{}", more.empty() ? "" : "; ", f.name, cell_of(f),
                          f.unit == "m"    ? " mm"
                          : f.unit.empty() ? ""
                                           : " " + f.unit);
  return fmt::format("{} {}{} |\n", row, r.error, more);
}

/// Returns the maximum of each number over the cases of one group.
HardResult worst_of(const std::vector<const HardResult*>& group) {
  HardResult worst = *group[0];
  worst.voxels = 0;
  for (const HardResult* r : group) {
    worst.voxels += r->voxels;
    for (HardFigure& f : worst.figures)
      for (const HardFigure& g : r->figures)
        if (g.name == f.name) f.measured = std::max(f.measured, g.measured);
  }
  return worst;
}

/// Returns whether the report has one row for the whole group.
bool is_grouped(const HardResult& r) {
  return r.group.starts_with("ties") || r.group.ends_with("leaves") || r.group == "classes";
}

std::string rows_of_groups(const HardBench& bench) {
  std::vector<std::string> groups;
  for (const HardResult& r : bench.cases)
    if (is_grouped(r) && std::find(groups.begin(), groups.end(), r.group) == groups.end()) groups.push_back(r.group);
  std::string rows;
  for (const std::string& group : groups) {
    std::vector<const HardResult*> holding;
    for (const HardResult& r : bench.cases)
      if (r.group == group && r.holds()) holding.push_back(&r);
    if (!holding.empty()) rows += row_of(fmt::format("{}: the worst of {}", group, holding.size()), worst_of(holding));
  }
  return rows;
}

std::string range_text(const std::optional<double>& low, double high) {
  return low && *low > 0 ? fmt::format("{:.3g} to {:.3g}", *low, high) : fmt::format("≤ {:.3g}", high);
}

std::string measured_text(const HardFigure& f) {
  const std::string value = fmt::format("{:.3g}", f.measured);
  return (f.goal->contains(f.measured) ? "**" + value + "**" : value) + (f.holds() ? "" : " **fails**");
}

/// Returns the texts of all values, or one text if all are equal.
template <class Text>
std::string joined(const std::vector<HardFigure>& figures, const Text& text_of) {
  std::vector<std::string> texts;
  for (const HardFigure& f : figures) texts.push_back(text_of(f));
  if (std::count(texts.begin(), texts.end(), texts.front()) == std::ptrdiff_t(texts.size())) return texts.front();
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// Returns the table of cases with goals, or "" if there is none.
std::string goals_table(const HardBench& bench) {
  std::string rows;
  for (const HardResult& r : bench.cases) {
    if (!has_goals(r)) continue;
    const auto name = [](const HardFigure& f) { return f.unit.empty() ? f.name : f.name + ", " + f.unit; };
    const auto bound = [](const HardFigure& f) { return range_text(f.at_least, f.bound); };
    const auto goal = [](const HardFigure& f) { return range_text(f.goal->low, f.goal->high); };
    rows += fmt::format("| `{}` | {} | {} | {} | {} |\n", r.name, joined(r.figures, name),
                        joined(r.figures, measured_text), joined(r.figures, bound), joined(r.figures, goal));
  }
  if (rows.empty()) return "";
  return "\n### Surfaces of real scenes\n\n" + goals_verdict(bench) +
         "\n| case | value | measured | bound | goal |\n| --- | --- | --- | --- | --- |\n" + rows + "\n" +
         goals_columns();
}

Json to_json(const HardFigure& f) {
  Json j{{"measured", f.measured}, {"bound", f.bound}, {"unit", f.unit}, {"holds", f.holds()}};
  if (f.at_least) j["at_least"] = *f.at_least;
  if (f.goal) {
    j["goal"] = {f.goal->low, f.goal->high};
    j["meets_goal"] = f.goal->contains(f.measured);
  }
  return j;
}

}  // namespace

std::string to_json(const HardBench& bench) {
  Json j{
      {"bench", "accuracy --hard"}, {"backend", bench.backend}, {"holds", bench.holds()}, {"verdict", verdict(bench)}};
  j["cases"] = Json::array();
  for (const HardResult& r : bench.cases) {
    Json one{{"name", r.name}, {"group", r.group}, {"what", r.what}, {"voxels", r.voxels}, {"holds", r.holds()}};
    if (!r.error.empty()) one["error"] = r.error;
    for (const HardFigure& f : r.figures) one["figures"][f.name] = to_json(f);
    j["cases"].push_back(std::move(one));
  }
  if (!bench.leaks.scenes.empty()) j["leaks"] = Json::parse(to_json(bench.leaks));
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_markdown(const HardBench& bench) {
  std::string out =
      verdict(bench) +
      "\n| case | voxels | missed | extra | alpha, codes | colour, codes | linear colour | normal, ° | position, mm | "
      "before the snap, mm | "
      "more |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  out += rows_of_groups(bench);
  for (const HardResult& r : bench.cases)
    if (!has_goals(r) && (!is_grouped(r) || !r.holds())) out += row_of("`" + r.name + "`", r);
  const auto failed =
      std::count_if(bench.cases.begin(), bench.cases.end(), [](const HardResult& r) { return !r.holds(); });
  out += fmt::format("\n{} cases on {}: {}\n", bench.cases.size(), bench.backend,
                     failed == 0 ? "every bound holds" : fmt::format("{} fail", failed));
  return out + "\n" + hard_columns() + goals_table(bench) + leaks_in_short(bench.leaks);
}

}  // namespace gigabake::bench
