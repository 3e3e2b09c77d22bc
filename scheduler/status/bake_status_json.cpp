#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "scheduler/status/bake_status.h"

namespace gigabake {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;
namespace fs = std::filesystem;

template <class T>
OrderedJson or_null(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

OrderedJson json_of(const CellTally& c) {
  return {{"planned", c.planned},     {"taken_over", c.taken_over},
          {"pending", c.pending},     {"running", c.running},
          {"done", c.done},           {"empty", c.empty},
          {"set_aside", c.set_aside}, {"failed_attempts", c.failed_attempts}};
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

constexpr int max_depth = 16;

/// Parses the text.
/// Errors  InputError.
Json parsed(const fs::path& file, std::string_view text) {
  const auto shallow = [&file](int depth, Json::parse_event_t, const Json&) {
    if (depth > max_depth) throw InputError(file, "", "is nested too deeply for the status of a bake");
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), shallow);
  } catch (const Json::parse_error& e) {
    throw InputError(file, "", "not valid JSON", std::uint64_t(e.byte));
  } catch (const Json::exception&) {
    throw InputError(file, "", "not valid JSON: holds a number that is out of range");
  }
}

/// A JSON object whose members are all required; messages name the member. Borrows file and object.
class Members {
 public:
  Members(const fs::path& file, const Json& object, std::string where)
      : file_(file), object_(object), where_(std::move(where)) {
    if (!object.is_object()) throw InputError(file_, where_, "expected an object");
  }

  std::uint64_t count(const char* key) const {
    if (!at(key).is_number_unsigned()) refuse(key, "expected a whole number that is not negative");
    return at(key).get<std::uint64_t>();
  }
  int small(const char* key) const {
    const std::uint64_t v = count(key);
    if (v > std::uint64_t(std::numeric_limits<int>::max())) refuse(key, "is too large");
    return int(v);
  }
  double number(const char* key) const {
    if (!at(key).is_number() || !std::isfinite(at(key).get<double>())) refuse(key, "expected a number");
    return at(key).get<double>();
  }
  std::string text(const char* key) const { return text_of(at(key), key); }
  bool truth(const char* key) const {
    if (!at(key).is_boolean()) refuse(key, "expected true or false");
    return at(key).get<bool>();
  }
  bool is_null(const char* key) const { return at(key).is_null(); }
  Members object(const char* key) const { return {file_, at(key), name_of_member(key)}; }
  /// Returns the elements of a list. read: converts one element's Members.
  template <class Read>
  auto list(const char* key, const Read& read) const {
    std::vector<decltype(read(*this))> values;
    for (const Json& element : array(key))
      values.push_back(read(Members(file_, element, std::string(key) + "[" + std::to_string(values.size()) + "]")));
    return values;
  }
  std::vector<std::string> texts(const char* key) const {
    std::vector<std::string> values;
    for (const Json& element : array(key)) values.push_back(text_of(element, key));
    return values;
  }
  [[noreturn]] void refuse(const char* key, const std::string& why) const {
    throw InputError(file_, name_of_member(key), why);
  }

 private:
  const Json& at(const char* key) const {
    const auto member = object_.find(key);
    if (member == object_.end()) refuse(key, "is missing");
    return *member;
  }
  const Json& array(const char* key) const {
    if (!at(key).is_array()) refuse(key, "expected a list");
    return at(key);
  }
  std::string text_of(const Json& value, const char* key) const {
    if (!value.is_string()) refuse(key, "expected a text");
    return value.get<std::string>();
  }
  std::string name_of_member(const char* key) const { return where_.empty() ? key : where_ + "." + key; }

  const fs::path& file_;
  const Json& object_;
  std::string where_;
};

BakeState state_of(const Members& m) {
  const std::string name = m.text("state");
  const std::optional<BakeState> state = value_named<BakeState>(name);
  if (!state) m.refuse("state", "is not a state of a bake: " + in_quotes(name));
  return *state;
}

CellTally tally_of(const Members& m) {
  return {m.count("planned"), m.count("taken_over"), m.count("pending"),   m.count("running"),
          m.count("done"),    m.count("empty"),      m.count("set_aside"), m.count("failed_attempts")};
}

Throughput throughput_of(const Members& m) {
  return {m.number("cells_per_s"), m.number("voxels_per_s"), m.number("bytes_per_s")};
}

SlowCell slow_cell_of(const Members& m) {
  SlowCell c{m.text("name"), m.number("seconds"), {}};
  if (!m.is_null("rank")) c.rank = m.small("rank");
  return c;
}

BakeFailure failure_of(const Members& m) { return {m.text("name"), m.text("line")}; }

WorkerStatus worker_of(const Members& m) {
  return {m.small("rank"), m.text("host"), m.truth("lost"), m.number("since_s"), m.texts("cells")};
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
  const Json json = parsed(file, text);
  const Members m(file, json, "");
  BakeStatus s;
  s.state = state_of(m);
  s.reason = m.text("reason");
  s.out = m.text("out");
  s.host = m.text("host");
  s.pid = m.small("pid");
  s.ranks = m.small("ranks");
  s.started_s = m.number("started_s");
  s.updated_s = m.number("updated_s");
  s.tiles_scanned = m.object("tiles").count("surveyed");
  s.tiles = m.object("tiles").count("all");
  s.cells = tally_of(m.object("cells"));
  s.voxels = m.count("voxels");
  s.bytes = m.count("bytes");
  s.recent = throughput_of(m.object("last_minute"));
  s.overall = throughput_of(m.object("overall"));
  if (!m.is_null("left_s")) s.left_s = m.number("left_s");
  const Members stages = m.object("stage_seconds");
  s.read_s = stages.number("read");
  s.kernel_s = stages.number("kernels");
  s.write_s = stages.number("write");
  s.slowest = m.list("slowest_cells", slow_cell_of);
  s.failures = m.count("failures");
  s.first_failures = m.list("first_failures", failure_of);
  s.process_restarts = m.count("process_restarts");
  s.workers_lost = m.count("workers_lost");
  s.workers = m.list("workers", worker_of);
  return s;
}

}  // namespace gigabake
