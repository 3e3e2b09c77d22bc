#include "query/volume/volume_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/error.h"
#include "core/base/valid_text.h"

namespace gigabake {
namespace {

/// Returns the value with a resolution of a tenth of `part` or finer.
std::string rounded(double value, double part) { return fmt::format("{:.{}f}", value, decimals_for(part / 10)); }

/// A member, its value, and whether the value is unknown if columns are missing.
struct VolumeMember {
  std::string name, value;
  bool needs_all = false;
};

std::vector<VolumeMember> members_of(const Volume& v) {
  const double square = v.column_m * v.column_m, cube = square * v.column_m;
  return {{"cut_m3", rounded(v.cut_m3, cube), true},
          {"cut_error_m3", rounded(v.cut_error_m3, cube), true},
          {"fill_m3", rounded(v.fill_m3, cube), true},
          {"fill_error_m3", rounded(v.fill_error_m3, cube), true},
          {"area_m2", rounded(v.area_m2(), square)},
          {"column_m", fmt::format("{}", v.column_m)},
          {"columns_measured", std::to_string(v.columns.measured)},
          {"columns_without_surface", std::to_string(v.columns.without_surface)},
          {"columns_outside", std::to_string(v.columns.outside)},
          {"columns_missing", std::to_string(v.columns.missing)}};
}

}  // namespace

void expect_volume_format(QueryFormat format) {
  if (format != QueryFormat::csv && format != QueryFormat::json)
    throw UsageError("format", "a volume is printed as csv or json");
}

std::string volume_text(const Volume& volume, const VolumeReference& reference, QueryFormat format) {
  expect_volume_format(format);
  const bool is_complete = volume.columns.missing == 0;
  std::vector<std::string> names, values;
  std::string json = reference.above_m ? fmt::format("{{\"above_m\":{}", *reference.above_m)
                                       : "{\"against\":" + nlohmann::json(valid_utf8(reference.against)).dump();
  for (const VolumeMember& m : members_of(volume)) {
    const bool is_known = is_complete || !m.needs_all;
    json += fmt::format(",\"{}\":{}", m.name, is_known ? m.value : "null");
    names.push_back(m.name);
    values.push_back(is_known ? m.value : "");
  }
  if (format == QueryFormat::json) return json + "}\n";
  return fmt::format("{}\n{}\n", fmt::join(names, ","), fmt::join(values, ","));
}

std::string volume_summary(const Volume& v) {
  const double cube = v.column_m * v.column_m * v.column_m;
  return fmt::format("{} ± {} m³ cut, {} ± {} m³ fill", rounded(v.cut_m3, cube), rounded(v.cut_error_m3, cube),
                     rounded(v.fill_m3, cube), rounded(v.fill_error_m3, cube));
}

}  // namespace gigabake
