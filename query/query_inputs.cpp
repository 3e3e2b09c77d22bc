#include "query/query_inputs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/error.h"

namespace gigabake {
namespace {

class SingleQuery final : public QuerySource {
 public:
  SingleQuery(QueryInput input, DirectionForm aim, std::string option)
      : input_{std::move(input)}, aim_(aim), option_(std::move(option)) {}

  void next(std::size_t, std::vector<QueryInput>& inputs) override { inputs = std::exchange(input_, {}); }
  DirectionForm aim() const override { return aim_; }
  std::optional<std::uint64_t> count() const override { return 1; }
  [[noreturn]] void refuse(std::size_t, const std::string& why) const override {
    throw UsageError(option_ + ": " + why);
  }

 private:
  std::vector<QueryInput> input_;
  DirectionForm aim_;
  std::string option_;
};

/// Returns the number of points from `low` to `high`. The factor 1 + 1e-12 includes the upper end if rounding places it
/// just beyond the last step.
std::uint64_t points_along(double low, double high, double step) {
  const double steps = (high - low) / step * (1 + 1e-12);
  return steps < 0x1p40 ? std::uint64_t(steps) + 1 : std::uint64_t(1) << 41;
}

class GridQueries final : public QuerySource {
 public:
  explicit GridQueries(const QueryGrid& grid) : grid_(grid) {
    bool good = std::isfinite(grid.step) && grid.step > 0;
    for (const double v : grid.box) good = good && std::isfinite(v);
    if (!good || grid.box[2] < grid.box[0] || grid.box[3] < grid.box[1])
      throw UsageError("grid", "expected finite numbers, the lower corner first, and a step above 0");
    columns_ = points_along(grid.box[0], grid.box[2], grid.step);
    rows_ = points_along(grid.box[1], grid.box[3], grid.step);
    constexpr std::uint64_t maximum = std::uint64_t(1) << 40;
    if (columns_ > maximum || rows_ > maximum || columns_ > maximum / rows_)
      throw UsageError("grid", "more than 2^40 points; expected a larger step or a smaller box");
  }

  void next(std::size_t maximum, std::vector<QueryInput>& inputs) override {
    first_ = at_;
    inputs.resize(std::size_t(std::min<std::uint64_t>(maximum, columns_ * rows_ - at_)));
    for (QueryInput& input : inputs) input.from = point(at_++);
  }
  std::optional<std::uint64_t> count() const override { return columns_ * rows_; }
  [[noreturn]] void refuse(std::size_t i, const std::string& why) const override {
    const QueryPoint p = point(first_ + i);
    throw UsageError("grid", "at " + std::to_string(p[0]) + "," + std::to_string(p[1]) + ": " + why);
  }

 private:
  QueryPoint point(std::uint64_t i) const {
    return {grid_.box[0] + double(i % columns_) * grid_.step, grid_.box[1] + double(i / columns_) * grid_.step, 0};
  }

  QueryGrid grid_;
  std::uint64_t columns_ = 0, rows_ = 0, at_ = 0, first_ = 0;
};

/// The fraction of a step below which the end of a profile replaces the last multiple of the step. The end of a line of
/// 100 m is rarely at exactly 100 m.
constexpr double min_last_step = 1e-3;

/// The stations of a profile.
class ProfileQueries final : public QuerySource {
 public:
  ProfileQueries(GeodesicPath path, double step_m, std::string option)
      : path_(std::move(path)), step_m_(step_m), option_(std::move(option)) {
    if (!(step_m > 0 && std::isfinite(step_m))) throw UsageError("step", "expected metres above 0");
    if (!(path_.length_m() > 0)) throw UsageError(option_ + ": all positions of the line are at the same place");
    const double steps = path_.length_m() / step_m;
    if (!(steps < 0x1p40))
      throw UsageError("step", "more than 2^40 stations; expected a larger step or a shorter line");
    stations_ = std::uint64_t(std::fmax(std::ceil(steps - min_last_step), 1)) + 1;
  }

  void next(std::size_t maximum, std::vector<QueryInput>& inputs) override {
    first_ = at_;
    inputs.resize(std::size_t(std::min<std::uint64_t>(maximum, stations_ - at_)));
    for (QueryInput& input : inputs) {
      input.station_m = station_m(at_++);
      const Geodetic p = path_.position(input.station_m);
      input.from = {p.longitude_deg, p.latitude_deg, 0};
    }
  }
  bool have_stations() const override { return true; }
  std::optional<std::uint64_t> count() const override { return stations_; }
  [[noreturn]] void refuse(std::size_t i, const std::string& why) const override {
    throw UsageError(option_ + ": at " + std::to_string(station_m(first_ + i)) + " m: " + why);
  }

 private:
  double station_m(std::uint64_t i) const { return i + 1 < stations_ ? double(i) * step_m_ : path_.length_m(); }

  GeodesicPath path_;
  double step_m_;
  std::string option_;
  std::uint64_t stations_ = 0, at_ = 0, first_ = 0;
};

}  // namespace

QueryRay ray_of(const QueryInput& input, QueryKind kind, DirectionForm aim, const QueryFrames& frames) {
  if (kind == QueryKind::height) return frames.down(input.from[0], input.from[1]);
  if (kind == QueryKind::sight) return frames.segment(input.from, input.to);
  if (aim == DirectionForm::direction) return frames.ray(input.from, input.to);
  if (aim == DirectionForm::angles) return frames.ray_by_angles(input.from, input.to[0], input.to[1]);
  return frames.ray_through(input.from, input.to);
}

std::unique_ptr<QuerySource> single_query(const QueryInput& input, DirectionForm aim, std::string option) {
  return std::make_unique<SingleQuery>(input, aim, std::move(option));
}

std::unique_ptr<QuerySource> grid_queries(const QueryGrid& grid) { return std::make_unique<GridQueries>(grid); }

std::unique_ptr<QuerySource> profile_queries(GeodesicPath path, double step_m, std::string option) {
  return std::make_unique<ProfileQueries>(std::move(path), step_m, std::move(option));
}

}  // namespace gigabake
