#include "cluster/launch/agreed_request.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

#include "cluster/mpi/collective.h"
#include "core/base/error.h"
#include "core/io/bytes.h"

namespace gigabake {
namespace {

namespace fs = std::filesystem;

/// Returns the absolute path; empty if a plan has no OUT.
fs::path place_of(const fs::path& path) { return path.empty() ? path : fs::absolute(path); }

/// Serializes the part of a request that affects results or the ranks' cooperation. Each rank keeps its own values for
/// the rest.
std::vector<std::uint8_t> shared_part(const BakeRequest& request) {
  ByteWriter w;
  w.put(place_of(request.source).string()), w.put(place_of(request.out).string());
  w.put(std::uint8_t(request.source_options.local));
  put_optional(w, request.source_options.origin);
  put_optional(w, request.source_options.scene_up);
  w.put(to_json(request.parameters));
  w.put(std::uint8_t(request.keep_going)), w.put(std::uint8_t(request.prune));
  w.put(std::uint8_t(request.overviews));
  w.put(request.timeouts.no_progress_s), w.put(request.timeouts.cell_timeout_s),
      w.put(request.timeouts.heartbeat_timeout_s);
  return w.take();
}

void take_shared_part(const std::vector<std::uint8_t>& bytes, BakeRequest& request) {
  ByteReader r(bytes, "request of rank 0");
  std::string source, out, parameters;
  r.get(source), r.get(out);
  r.get(request.source_options.local);
  get_optional(r, request.source_options.origin);
  get_optional(r, request.source_options.scene_up);
  r.get(parameters);
  r.get(request.keep_going), r.get(request.prune), r.get(request.overviews);
  r.get(request.timeouts.no_progress_s), r.get(request.timeouts.cell_timeout_s),
      r.get(request.timeouts.heartbeat_timeout_s);
  r.expect_end();
  request.source = source, request.out = out;
  request.parameters = parameters_from_json(parameters);
}

/// Returns the options as a user would write them. The complete parameters come last, because they include values that
/// no other option names.
std::vector<NamedOption> named_options(const BakeRequest& request) {
  const BakeParameters& p = request.parameters;
  const SourceOptions& s = request.source_options;
  return {
      {"`voxel_size_m`", fmt::format("{}", p.voxel_size_m)},
      {"`surface`", std::string(name_of(p.surface))},
      {"`mip`", std::string(name_of(p.mip))},
      {"`channels`",
       fmt::format("{}{}", p.normals ? "with normals" : "without normals", p.directional_coverage ? ", facing" : "")},
      {"`max_error`", fmt::format("{}", p.max_error)},
      {"`depth_error`", fmt::format("{}", p.depth_error)},
      {"`codec`", std::string(name_of(p.codec))},
      {"`cell_voxels`", fmt::format("{}", p.cell_voxels)},
      {"`lattice_origin_m`", fmt::format("{}", fmt::join(p.lattice_origin_m, ","))},
      {"`local`", s.local ? "given" : "not given"},
      {"`origin`", s.origin
                       ? fmt::format("{},{},{}", s.origin->latitude_deg, s.origin->longitude_deg, s.origin->height_m)
                       : "the source's own"},
      {"`bounds`, `clip` or `crs`", request.area_text.empty() ? "not given" : request.area_text},
      {"`ortho`, `dem_crs`, `nodata` or `geoid_offset_m`",
       request.raster_text.empty() ? "not given" : request.raster_text},
      {"`up`", s.scene_up ? std::string(name_of(*s.scene_up)) : "the source's own"},
      {"`no_keep_going`", request.keep_going ? "not given" : "given"},
      {"`no_overviews`", request.overviews ? "not given" : "given"},
      {"`prune`", request.prune ? "given" : "not given"},
      {"parameters", to_json(p)},
  };
}

/// Returns rank 0's absolute path if rank 0 was given the same text, because working directories may differ. Otherwise
/// returns this rank's absolute path, which must equal rank 0's.
NamedOption named_path(MpiSession& mpi, const char* name, const fs::path& path) {
  const std::string typed = path.string();
  const std::vector<std::uint8_t> of_first = mpi.from_master(std::vector<std::uint8_t>(typed.begin(), typed.end()));
  const bool is_typed_alike = std::string(of_first.begin(), of_first.end()) == typed;
  const std::string place = place_of(path).lexically_normal().string();
  const std::vector<std::uint8_t> there = mpi.from_master(std::vector<std::uint8_t>(place.begin(), place.end()));
  return {name, is_typed_alike ? std::string(there.begin(), there.end()) : place};
}

}  // namespace

void expect_same_options(MpiSession& mpi, const std::vector<NamedOption>& own) {
  ByteWriter w;
  for (const NamedOption& option : own) w.put(option.value);
  const std::vector<std::uint8_t> of_first = mpi.from_master(w.take());
  check_options_collectively(mpi, [&] {
    ByteReader r(of_first, "options of rank 0");
    for (const NamedOption& option : own) {
      std::string first;
      r.get(first);
      if (first != option.value)
        throw UsageError(
            fmt::format("{} is {} on this rank and {} on rank 0; all ranks of a launch need the same "
                        "options",
                        option.name, as_line(option.value, max_quote_bytes), as_line(first, max_quote_bytes)));
    }
    r.expect_end();
  });
}

BakeRequest agreed_request(MpiSession& mpi, const BakeRequest& own) {
  if (mpi.ranks() == 1) return own;
  std::vector<NamedOption> options = {named_path(mpi, "SOURCE", own.source), named_path(mpi, "`out`", own.out)};
  for (NamedOption& option : named_options(own)) options.push_back(std::move(option));
  expect_same_options(mpi, options);
  BakeRequest agreed = own;
  take_shared_part(mpi.from_master(shared_part(own)), agreed);
  return agreed;
}

}  // namespace gigabake
