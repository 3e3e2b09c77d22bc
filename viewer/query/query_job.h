/// From questions to text: batch by batch, so that neither the questions nor the answers need be in memory.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

#include "lattice/progress.h"
#include "viewer/query/query_asks.h"
#include "viewer/query/query_text.h"
#include "viewer/query/scene_query.h"

namespace gigabake {

struct QueryJob {
  QueryKind kind = QueryKind::ray;
  QueryFrame frame = QueryFrame::scene;
  QueryFormat format = QueryFormat::csv;
  double most_distance_m = std::numeric_limits<double>::infinity();
  /// Of a line of sight: what is this near to either of its points does not block it.
  double ends_m = 0;
  std::size_t rays_at_a_time = std::size_t(1) << 17;
};

/// By outcome.
using QueryTally = std::array<std::uint64_t, names_of<QueryOutcome>().size()>;

/// write: the next piece of the text; called from this thread.
/// Exact   The same text for every number of threads and rays at a time, and all memory.
/// Errors  As SceneQuery::first_hits() and QueryAsks::refuse(); what write throws.
QueryTally run_query(const QueryJob& job, SceneQuery& query, QueryAsks& asks, const ThreadPool& pool,
                     const std::function<void(std::string_view)>& write, const Progress& progress = {});

}  // namespace gigabake
