/// Sequences of queries: from a table, from a grid of points, or from command-line options.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/math/geodesic.h"
#include "query/query_frames.h"

namespace gigabake {

enum class QueryKind : std::uint8_t {
  ray,     ///< the first voxel along a ray
  height,  ///< the highest surface at a place
  sight    ///< line of sight between two points
};

/// The form in which a ray's direction is given.
enum class DirectionForm : std::uint8_t { direction, angles, point };

struct QueryInput {
  std::string id;
  QueryPoint from{};     ///< a height query ignores the third coordinate
  QueryPoint to{};       ///< direction, second point, or azimuth and elevation (degrees); unused by height queries
  double station_m = 0;  ///< distance along the line of a profile
};

/// Returns the ray of a query.
/// Errors  std::invalid_argument: the errors of QueryFrames.
QueryRay ray_of(const QueryInput& input, QueryKind kind, DirectionForm aim, const QueryFrames& frames);

class QuerySource {
 public:
  virtual ~QuerySource() = default;

  /// Replaces `inputs` by the next queries, at most `maximum`; by none at the end. Reuses the memory of `inputs`.
  virtual void next(std::size_t maximum, std::vector<QueryInput>& inputs) = 0;
  virtual DirectionForm aim() const { return DirectionForm::point; }
  virtual bool have_ids() const { return false; }
  virtual bool have_stations() const { return false; }
  /// Returns the total number of queries; nullopt if it is unknown.
  virtual std::optional<std::uint64_t> count() const { return {}; }
  /// Reports that query i of the last next() is invalid.
  /// Errors  InputError or UsageError: always.
  [[noreturn]] virtual void refuse(std::size_t i, const std::string& why) const = 0;
};

/// Returns a sequence of one query. `option` is the name of the command-line option that states the query, for
/// messages.
std::unique_ptr<QuerySource> single_query(const QueryInput& input, DirectionForm aim, std::string option);

/// A grid of points with the distance `step`. It begins at the lower corner of the box. The points are ordered row by
/// row, in ascending order of the second coordinate. Box and step have the units of the query's frame.
struct QueryGrid {
  std::array<double, 4> box{};  ///< low x, low y, high x, high y; or longitudes and latitudes
  double step = 0;
};
/// Returns a height query for each point of the grid.
/// Errors  UsageError: the grid has no points, or more than 2^40.
std::unique_ptr<QuerySource> grid_queries(const QueryGrid& grid);

/// Returns height queries along a line, in geographic coordinates: at its begin, at each multiple of `step_m`, and at
/// its end. `option` is the name of the command-line option that states the line, for messages.
/// Errors  UsageError: the line has no length, the step is not above 0, or there are more than 2^40 queries.
std::unique_ptr<QuerySource> profile_queries(GeodesicPath path, double step_m, std::string option);

/// Returns the queries of a file; "-" is standard input. A file that begins with the magic bytes of NumPy's .npy format
/// is read as a .npy array (query_npy.h). Any other file is CSV with a header line that names the columns, in any
/// order. Scene coordinates use x,y,z, geographic coordinates lon,lat,height; a height query has no third coordinate. A
/// ray also needs dx,dy,dz (scene coordinates only), azimuth,elevation, or a second point. A line of sight needs its
/// end point. The columns of a second point or an end point have the prefix to_. The optional column id is copied to
/// the answer.
/// Errors  InputError, also from next(): the file cannot be read. InputError with the line: a missing, unknown or
///         repeated column, a wrong number of fields, or a field that is not a finite number. Errors of a .npy file
///         name the byte.
std::unique_ptr<QuerySource> table_queries(const std::filesystem::path& file, QueryKind kind, QueryFrame frame,
                                           const ThreadPool& pool);

}  // namespace gigabake
