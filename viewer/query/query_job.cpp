#include "viewer/query/query_job.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "viewer/query/surface_height.h"

namespace gigabake {
namespace {

constexpr std::size_t answers_per_piece = 1024;

class Run {
 public:
  Run(const QueryJob& job, SceneQuery& query, QuerySource& asks, const ThreadPool& pool)
      : job_(job),
        query_(query),
        asks_(asks),
        pool_(pool),
        surface_(parameters_from_json(query.scene().header().parameters).surface),
        frames_(query.scene().header(), query.window(), job.frame),
        text_(job.format, job.kind, frames_, query.scene().header().voxel_size_m, asks.have_ids()) {
    if (!(job.max_distance_m > 0)) throw UsageError("max_distance", "expected metres above 0");
    if (!(job.ignore_ends_m >= 0 && std::isfinite(job.ignore_ends_m)))
      throw UsageError("ignore_ends", "expected metres, 0 or more");
  }

  QueryTally all(const std::function<void(std::string_view)>& write, const Progress& progress) {
    QueryTally tally{};
    bool first = true;
    for (;;) {
      const std::vector<QueryInput> asks = asks_.next(job_.batch_rays);
      if (asks.empty()) break;
      const std::vector<QueryRay> rays = rays_of(asks);
      std::vector<QueryHit> hits(rays.size());
      query_.first_hits(rays, hits, progress);
      if (job_.kind == QueryKind::height) move_to_surface(query_, surface_, rays, hits, progress);
      for (const QueryHit& hit : hits) ++tally[std::size_t(hit.outcome)];
      if (first) write(text_.begin());  // deferred, because the first query may be invalid
      for (const std::string& piece : texts(asks, rays, hits, first)) write(piece);
      first = false;
    }
    if (first) write(text_.begin());
    write(text_.end());
    return tally;
  }

 private:
  QueryRay ray_for(const QueryInput& ask) const {
    QueryRay ray = ray_of(ask, job_.kind, asks_.aim(), frames_);
    if (job_.kind == QueryKind::height) return ray;
    ray.end = std::fmin(ray.end, frames_.voxels(job_.max_distance_m));
    if (job_.kind != QueryKind::sight) return ray;
    ray.begin = frames_.voxels(job_.ignore_ends_m);
    ray.end -= ray.begin;
    if (!(ray.begin < ray.end))
      throw std::invalid_argument("the ignored ends cover the whole line between the two points");
    return ray;
  }

  std::vector<QueryRay> rays_of(const std::vector<QueryInput>& asks) const {
    std::vector<QueryRay> rays(asks.size());
    std::mutex mutex;
    std::size_t first_bad = asks.size();
    std::string why;
    pool_.parallel_for(asks.size(), answers_per_piece, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        try {
          rays[i] = ray_for(asks[i]);
        } catch (const std::invalid_argument& bad) {
          const std::scoped_lock lock(mutex);
          if (i < first_bad) why = bad.what();
          first_bad = std::min(first_bad, i);
          return;
        }
      }
    });
    if (first_bad < asks.size()) asks_.refuse(first_bad, why);
    return rays;
  }

  std::vector<const std::string*> names_of_shards(const std::vector<QueryHit>& hits) {
    static const std::string none;
    std::vector<const std::string*> names(hits.size(), &none);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      const std::uint32_t shard = hits[i].shard;
      if (shard == QueryHit::no_shard) continue;
      names[i] = i > 0 && hits[i - 1].shard == shard ? names[i - 1] : &query_.name_of(shard);
    }
    return names;
  }

  std::vector<std::string> texts(const std::vector<QueryInput>& asks, const std::vector<QueryRay>& rays,
                                 const std::vector<QueryHit>& hits, bool first) {
    const std::vector<const std::string*> names = names_of_shards(hits);
    std::vector<std::string> pieces((hits.size() + answers_per_piece - 1) / answers_per_piece);
    pool_.parallel_for(pieces.size(), 1, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t p = begin; p < end; ++p)
        for (std::size_t i = p * answers_per_piece; i < std::min(hits.size(), (p + 1) * answers_per_piece); ++i)
          text_.add({asks[i], rays[i], hits[i], *names[i]}, first && i == 0, pieces[p]);
    });
    return pieces;
  }

  const QueryJob& job_;
  SceneQuery& query_;
  QuerySource& asks_;
  const ThreadPool& pool_;
  SurfaceRule surface_;
  QueryFrames frames_;
  QueryText text_;
};

}  // namespace

QueryTally run_query(const QueryJob& job, SceneQuery& query, QuerySource& asks, const ThreadPool& pool,
                     const std::function<void(std::string_view)>& write, const Progress& progress) {
  progress.step("casting rays", asks.count(), "ray");
  return Run(job, query, asks, pool).all(write, progress);
}

}  // namespace gigabake
