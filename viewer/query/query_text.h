/// Answers as text: CSV, JSON or GeoJSON, a piece for each answer between a begin and an end.
#pragma once

#include <string>

#include "viewer/query/query_asks.h"
#include "viewer/query/query_frames.h"
#include "viewer/query/query_ray.h"

namespace gigabake {

enum class QueryFormat : std::uint8_t { csv, json, geojson };
template <>
constexpr auto names_of<QueryFormat>() {
  return std::to_array<std::string_view>({"csv", "json", "geojson"});
}

/// One question and what came of it.
struct QueryAnswer {
  const QueryAsk& ask;
  const QueryRay& ray;
  const QueryHit& hit;
  const std::string& shard;  ///< name of the cell or the parent; empty where there is none
};

/// Lengths are printed to a thousandth of a voxel, degrees to less than that on the ground. A height is known to half a
/// voxel of its level, and is printed to a tenth.
class QueryText {
 public:
  /// Errors  UsageError: GeoJSON of a scene that stands nowhere on earth.
  QueryText(QueryFormat format, QueryKind kind, const QueryFrames& frames, double voxel_size_m, bool has_ids);

  std::string begin() const;
  /// first: of all.
  void add(const QueryAnswer& answer, bool first, std::string& text) const;
  std::string end() const;

 private:
  void add_csv(const QueryAnswer& answer, std::string& text) const;
  void add_json(const QueryAnswer& answer, std::string& text) const;
  void add_geojson(const QueryAnswer& answer, std::string& text) const;
  void add_members(const QueryAnswer& answer, bool with_scene_metres, std::string& text) const;
  void add_point(const QueryPoint& p, int height_decimals, std::string& text) const;
  void add_lonlat(const QueryPoint& p, int height_decimals, std::string& text) const;
  /// Decimals of the third coordinate, and of a distance to it.
  int height_decimals(const QueryHit& hit) const;
  double height_error_m(const QueryHit& hit) const;
  QueryPoint asked_lonlat(const QueryPoint& asked) const;
  std::string_view outcome(QueryOutcome outcome) const;

  QueryFormat format_;
  QueryKind kind_;
  const QueryFrames& frames_;
  int decimals_;  ///< of metres
  bool has_ids_;
};

}  // namespace gigabake
