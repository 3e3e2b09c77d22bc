/// Formatting of answers as CSV, JSON, GeoJSON or a NumPy array.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "query/first_hit/query_ray.h"
#include "query/query_frames.h"
#include "query/query_inputs.h"

namespace gigabake {

enum class QueryFormat : std::uint8_t { csv, json, geojson, npy };
template <>
constexpr auto names_of<QueryFormat>() {
  return std::to_array<std::string_view>({"csv", "json", "geojson", "npy"});
}

/// A query and its answer.
struct QueryAnswer {
  const QueryInput& input;
  const QueryRay& ray;
  const QueryHit& hit;
  const std::string& shard;  ///< name of the cell or overview; empty if there is none
};

/// Returns the number of decimals, at most nine, that resolve `step`.
int decimals_for(double step);

/// The columns that some sources of queries and some scenes add to the answers.
struct QueryColumns {
  bool ids = false, stations = false, classes = false;
};

/// A formatter of answers. The text of a result consists of begin(), the text of each answer, and end().
/// Lengths are printed with a resolution of 1/1000 voxel or finer. Degrees are printed with a finer resolution on the
/// ground. Heights are printed with a resolution of 1/10 voxel of their level or finer, because their error is half a
/// voxel.
class QueryText {
 public:
  /// Takes the number of answers, `count`, if it is known.
  /// Errors  UsageError: GeoJSON of a scene that is not georeferenced; an array of an unknown number of answers.
  QueryText(QueryFormat format, QueryKind kind, const QueryFrames& frames, double voxel_size_m, QueryColumns columns,
            std::optional<std::uint64_t> count);

  std::string begin() const;
  /// Appends an answer. `first` is true for the first answer of the result.
  void add(const QueryAnswer& answer, bool first, std::string& text) const;
  std::string end() const;

 private:
  void add_csv(const QueryAnswer& answer, std::string& text) const;
  void add_json(const QueryAnswer& answer, std::string& text) const;
  void add_geojson(const QueryAnswer& answer, std::string& text) const;
  void add_outcome(const QueryAnswer& answer, std::string& text) const;
  void add_place(const QueryAnswer& answer, std::string& text) const;
  void add_members(const QueryAnswer& answer, std::string& text) const;
  void add_properties(const QueryAnswer& answer, std::string& text) const;
  void add_point(const QueryPoint& p, int height_decimals, std::string& text) const;
  void add_lonlat(const QueryPoint& p, int height_decimals, std::string& text) const;
  /// Returns the number of decimals of a hit's third coordinate and distance.
  int height_decimals(const QueryHit& hit) const;
  double height_error_m(const QueryHit& hit) const;
  QueryPoint input_lonlat(const QueryPoint& asked) const;
  std::string_view outcome(QueryOutcome outcome) const;

  QueryFormat format_;
  QueryKind kind_;
  const QueryFrames& frames_;
  int decimals_;  ///< number of decimals of metres
  QueryColumns columns_;
  std::uint64_t count_;  ///< number of answers; 0 if unknown
};

}  // namespace gigabake
