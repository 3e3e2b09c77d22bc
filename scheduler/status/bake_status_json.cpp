#include <nlohmann/json.hpp>

#include "format/system/json/json_members.h"
#include "scheduler/status/bake_status.h"

namespace gigabake {
namespace {

using OrderedJson = nlohmann::ordered_json;
namespace fs = std::filesystem;

template <class T>
OrderedJson or_null(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

OrderedJson json_of(const CellTally& c) {
  return {{"planned", c.planned},
          {"taken_over", c.taken_over},
          {"pending", c.pending},
          {"running", c.running},
          {"done", c.done},
          {"empty", c.empty},
          {"set_aside", c.quarantined},
          {"failed_attempts", c.failed_attempts}};
}

OrderedJson json_of(const Throughput& t) {
  return {{"cells_per_s", t.cells_per_s}, {"voxels_per_s", t.voxels_per_s}, {"bytes_per_s", t.bytes_per_s}};
}

OrderedJson json_of(const SlowCell& c) { return {{"name", c.name}, {"seconds", c.seconds}, {"rank", or_null(c.rank)}}; }

OrderedJson json_of(const BakeFailure& f) { return {{"name", f.name}, {"line", f.line}}; }

OrderedJson json_of(const WorkerStatus& w) {
  return {{"rank", w.rank}, {"host", w.host}, {"lost", w.lost}, {"since_s", w.since_s}, {"cells", w.cells}};
}

template <class T>
OrderedJson json_of(const std::vector<T>& values) {
  OrderedJson list = OrderedJson::array();
  for (const T& v : values) list.push_back(json_of(v));
  return list;
}

CellTally tally_of(const JsonMembers& m) {
  return {m.get<std::uint64_t>("planned"),   m.get<std::uint64_t>("taken_over"),     m.get<std::uint64_t>("pending"),
          m.get<std::uint64_t>("running"),   m.get<std::uint64_t>("done"),           m.get<std::uint64_t>("empty"),
          m.get<std::uint64_t>("set_aside"), m.get<std::uint64_t>("failed_attempts")};
}

Throughput throughput_of(const JsonMembers& m) {
  return {m.get<double>("cells_per_s"), m.get<double>("voxels_per_s"), m.get<double>("bytes_per_s")};
}

SlowCell slow_cell_of(const JsonMembers& m) {
  SlowCell c{m.get<std::string>("name"), m.get<double>("seconds"), {}};
  if (!m.is_null("rank")) c.rank = m.get<int>("rank");
  return c;
}

BakeFailure failure_of(const JsonMembers& m) { return {m.get<std::string>("name"), m.get<std::string>("line")}; }

WorkerStatus worker_of(const JsonMembers& m) {
  return {m.get<int>("rank"), m.get<std::string>("host"), m.get<bool>("lost"), m.get<double>("since_s"),
          m.texts("cells")};
}

}  // namespace

std::string to_json(const BakeStatus& s) {
  OrderedJson j{{"state", name_of(s.state)}, {"reason", s.reason}, {"out", s.out}, {"host", s.host}, {"pid", s.pid}};
  j["ranks"] = s.ranks;
  j["started_s"] = s.started_s;
  j["updated_s"] = s.updated_s;
  j["tiles"] = {{"surveyed", s.tiles_scanned}, {"all", s.tiles}};
  j["cells"] = json_of(s.cells);
  j["voxels"] = s.voxels;
  j["bytes"] = s.bytes;
  j["last_minute"] = json_of(s.recent);
  j["overall"] = json_of(s.overall);
  j["left_s"] = or_null(s.left_s);
  j["stage_seconds"] = {{"read", s.read_s}, {"kernels", s.kernel_s}, {"write", s.write_s}};
  j["slowest_cells"] = json_of(s.slowest);
  j["failures"] = s.failures;
  j["first_failures"] = json_of(s.first_failures);
  j["process_restarts"] = s.process_restarts;
  j["workers_lost"] = s.workers_lost;
  j["workers"] = json_of(s.workers);
  return j.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

BakeStatus status_from_json(const fs::path& file, std::string_view text) {
  const nlohmann::json json = parse_json_object(file, text);
  const JsonMembers m(file, json, "", JsonNull::refused);
  BakeStatus s;
  s.state = m.get<BakeState>("state");
  s.reason = m.get<std::string>("reason");
  s.out = m.get<std::string>("out");
  s.host = m.get<std::string>("host");
  s.pid = m.get<int>("pid");
  s.ranks = m.get<int>("ranks");
  s.started_s = m.get<double>("started_s");
  s.updated_s = m.get<double>("updated_s");
  s.tiles_scanned = m.members("tiles").get<std::uint64_t>("surveyed");
  s.tiles = m.members("tiles").get<std::uint64_t>("all");
  s.cells = tally_of(m.members("cells"));
  s.voxels = m.get<std::uint64_t>("voxels");
  s.bytes = m.get<std::uint64_t>("bytes");
  s.recent = throughput_of(m.members("last_minute"));
  s.overall = throughput_of(m.members("overall"));
  if (!m.is_null("left_s")) s.left_s = m.get<double>("left_s");
  const JsonMembers stages = m.members("stage_seconds");
  s.read_s = stages.get<double>("read");
  s.kernel_s = stages.get<double>("kernels");
  s.write_s = stages.get<double>("write");
  s.slowest = m.list("slowest_cells", slow_cell_of);
  s.failures = m.get<std::uint64_t>("failures");
  s.first_failures = m.list("first_failures", failure_of);
  s.process_restarts = m.get<std::uint64_t>("process_restarts");
  s.workers_lost = m.get<std::uint64_t>("workers_lost");
  s.workers = m.list("workers", worker_of);
  return s;
}

}  // namespace gigabake
