/// What people ask, one after the other: from a table, of a grid of points, or as they typed it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lattice/thread_pool.h"
#include "viewer/query/query_frames.h"

namespace gigabake {

enum class QueryKind : std::uint8_t {
  ray,     ///< what a ray meets first
  height,  ///< what stands highest at a place
  sight    ///< whether two points see each other
};

/// How a ray's direction is said.
enum class QueryAim : std::uint8_t { direction, angles, point };

struct QueryAsk {
  std::string id;
  QueryPoint from{};  ///< height: the third does not count
  QueryPoint to{};    ///< direction, point, or azimuth and elevation; height: nothing
};

/// Errors  std::invalid_argument, as QueryFrames.
QueryRay ray_of(const QueryAsk& ask, QueryKind kind, QueryAim aim, const QueryFrames& frames);

class QueryAsks {
 public:
  virtual ~QueryAsks() = default;

  /// The next ones, at most so many; none where there are no more.
  virtual std::vector<QueryAsk> next(std::size_t most) = 0;
  virtual QueryAim aim() const { return QueryAim::point; }
  virtual bool have_ids() const { return false; }
  /// How many there are in all; 0 where that is not known.
  virtual std::uint64_t count() const { return 0; }
  /// Refuses ask i of those that the last next() gave. Errors  InputError or UsageError: always.
  [[noreturn]] virtual void refuse(std::size_t i, const std::string& why) const = 0;
};

/// One, which options have said.
/// option: for messages.
std::unique_ptr<QueryAsks> one_ask(const QueryAsk& ask, QueryAim aim, std::string option);

/// Points on lines from the lower corner on, `step` apart, row by row from the second coordinate's low end.
struct QueryGrid {
  std::array<double, 4> box{};  ///< low x, low y, high x, high y, or longitudes and latitudes
  double step = 0;
};
/// Errors  UsageError: a grid without points, or of more than 2^40.
std::unique_ptr<QueryAsks> grid_asks(const QueryGrid& grid);

/// A CSV file with a head line; "-": standard input. Columns, by name, in any order: of scene metres x,y,z; of lonlat
/// lon,lat,height; a ray's besides them dx,dy,dz (scene alone), or azimuth,elevation, or a point that it goes through
/// or a line of sight ends at, with to_ before the names; a height's no third; and an id, which the answer repeats.
/// Errors  InputError, of next() too: no such file, and with the line: a column that is missing, unknown or twice, too
///         few or too many fields, no finite number.
std::unique_ptr<QueryAsks> table_asks(const std::filesystem::path& file, QueryKind kind, QueryFrame frame,
                                      const ThreadPool& pool);

}  // namespace gigabake
