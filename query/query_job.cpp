#include "query/query_job.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/octree/parameters.h"
#include "query/surface_height.h"

namespace gigabake {
namespace {

constexpr std::size_t answers_per_piece = 1024;

class Run {
 public:
  Run(const QueryJob& job, SceneQuery& query, QuerySource& inputs, const ThreadPool& pool)
      : job_(job),
        query_(query),
        asks_(inputs),
        pool_(pool),
        surface_(parameters_from_json(query.scene().header().parameters).surface),
        frames_(query.scene().header(), query.window(), job.frame, job.crs),
        text_(job.format, job.kind, frames_, query.scene().header().voxel_size_m,
              {inputs.have_ids(), inputs.have_stations(), query.scene().header().has_classes}, inputs.count()) {
    if (!(job.max_distance_m > 0)) throw UsageError("max_distance", "expected metres above 0");
    if (!(job.ignore_ends_m >= 0 && std::isfinite(job.ignore_ends_m)))
      throw UsageError("ignore_ends", "expected metres, 0 or more");
  }

  QueryTally all(const std::function<void(std::string_view)>& write, const Progress& progress) {
    QueryTally tally{};
    bool first = true;
    Batch batch, following;
    read(batch);
    for (; !batch.inputs.empty(); std::swap(batch, following)) {
      // The next batch is read while this batch is cast and written. Errors of the next batch are reported after the
      // answers of this batch.
      std::future<void> reading = std::async(std::launch::async, [&] { read(following); });
      hits_.resize(batch.rays.size());
      query_.first_hits(batch.rays, hits_, progress);
      if (job_.kind == QueryKind::height) move_to_surface(query_, surface_, batch.rays, hits_, progress);
      for (const QueryHit& hit : hits_) ++tally[std::size_t(hit.outcome)];
      if (first) write(text_.begin());  // deferred, because the first query may be invalid
      format(batch, first);
      for (const std::string& piece : pieces_) write(piece);
      first = false;
      reading.get();
    }
    if (first) write(text_.begin());
    write(text_.end());
    return tally;
  }

 private:
  struct Batch {
    std::vector<QueryInput> inputs;
    std::vector<QueryRay> rays;
  };

  void read(Batch& batch) {
    asks_.next(job_.batch_rays, batch.inputs);
    make_rays(batch.inputs, batch.rays);
  }

  QueryRay ray_for(const QueryInput& input) const {
    QueryRay ray = ray_of(input, job_.kind, asks_.aim(), frames_);
    if (job_.kind == QueryKind::height) return ray;
    ray.end = std::fmin(ray.end, frames_.voxels(job_.max_distance_m));
    if (job_.kind != QueryKind::sight) return ray;
    ray.begin = frames_.voxels(job_.ignore_ends_m);
    ray.end -= ray.begin;
    if (!(ray.begin < ray.end))
      throw std::invalid_argument("the ignored ends cover the whole line between the two points");
    return ray;
  }

  void make_rays(const std::vector<QueryInput>& inputs, std::vector<QueryRay>& rays) const {
    rays.resize(inputs.size());
    std::mutex mutex;
    std::size_t first_bad = inputs.size();
    std::string why;
    pool_.parallel_for(inputs.size(), answers_per_piece, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t i = begin; i < end; ++i) {
        try {
          rays[i] = ray_for(inputs[i]);
        } catch (const std::invalid_argument& bad) {
          const std::scoped_lock lock(mutex);
          if (i < first_bad) why = bad.what();
          first_bad = std::min(first_bad, i);
          return;
        }
      }
    });
    if (first_bad < inputs.size()) asks_.refuse(first_bad, why);
  }

  /// Looks up the names of the hits' shards.
  void find_names() {
    static const std::string none;
    names_.assign(hits_.size(), &none);
    if (job_.format == QueryFormat::npy) return;
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const std::uint32_t shard = hits_[i].shard;
      if (shard == QueryHit::no_shard) continue;
      names_[i] = i > 0 && hits_[i - 1].shard == shard ? names_[i - 1] : &query_.name_of(shard);
    }
  }

  /// Formats the batch into the pieces of text. `first` is true for the first batch.
  void format(const Batch& batch, bool first) {
    find_names();
    pieces_.resize((hits_.size() + answers_per_piece - 1) / answers_per_piece);
    pool_.parallel_for(pieces_.size(), 1, [&](std::size_t begin, std::size_t end, int) {
      for (std::size_t p = begin; p < end; ++p) {
        pieces_[p].clear();
        for (std::size_t i = p * answers_per_piece; i < std::min(hits_.size(), (p + 1) * answers_per_piece); ++i)
          text_.add({batch.inputs[i], batch.rays[i], hits_[i], *names_[i]}, first && i == 0, pieces_[p]);
      }
    });
  }

  const QueryJob& job_;
  SceneQuery& query_;
  QuerySource& asks_;
  const ThreadPool& pool_;
  SurfaceRule surface_;
  QueryFrames frames_;
  QueryText text_;
  std::vector<QueryHit> hits_;  ///< of a batch, like the next two members
  std::vector<const std::string*> names_;
  std::vector<std::string> pieces_;
};

}  // namespace

QueryTally run_query(const QueryJob& job, SceneQuery& query, QuerySource& inputs, const ThreadPool& pool,
                     const std::function<void(std::string_view)>& write, const Progress& progress) {
  progress.step("casting rays", inputs.count().value_or(0), "ray");
  return Run(job, query, inputs, pool).all(write, progress);
}

}  // namespace gigabake
