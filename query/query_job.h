/// Execution of queries in batches, from input to text; neither all queries nor all answers are in memory at once.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "core/base/progress.h"
#include "query/query_inputs.h"
#include "query/query_text.h"
#include "query/scene_query.h"

namespace gigabake {

struct QueryJob {
  QueryKind kind = QueryKind::ray;
  QueryFrame frame = QueryFrame::scene;
  std::shared_ptr<const CrsMap> crs = nullptr;  ///< of QueryFrame::crs
  QueryFormat format = QueryFormat::csv;
  double max_distance_m = std::numeric_limits<double>::infinity();
  /// Voxels closer than this to either end point do not block a line of sight.
  double ignore_ends_m = 0;
  std::size_t batch_rays = std::size_t(1) << 17;
};

/// Number of answers per outcome.
using QueryTally = std::array<std::uint64_t, names_of<QueryOutcome>().size()>;

/// Answers all queries and passes the text to `write`, piece by piece, in the calling thread.
/// Exact   The text does not depend on the number of threads, the batch size or the memory.
/// Errors  The errors of SceneQuery::first_hits() and QuerySource::refuse(); exceptions of `write`.
QueryTally run_query(const QueryJob& job, SceneQuery& query, QuerySource& inputs, const ThreadPool& pool,
                     const std::function<void(std::string_view)>& write, const Progress& progress = {});

}  // namespace gigabake
