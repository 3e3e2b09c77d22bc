/// Writer of OUT/plan (scheduler/journal/plan_record.h), with which viewers follow a bake. Only rank 0 has this object.
#pragma once

#include <filesystem>

#include "cluster/bake/bake_session.h"
#include "scheduler/status/bake_event.h"

namespace gigabake {

class PlanFile {
 public:
  /// Writes the planned cells of the session, which must outlive this object. If the file cannot be written, reports a
  /// warning; the bake continues.
  explicit PlanFile(const BakeSession& session);
  /// Removes the file.
  ~PlanFile();
  PlanFile(const PlanFile&) = delete;
  PlanFile& operator=(const PlanFile&) = delete;

  /// Appends the cell of a JobQuarantined event; ignores other events.
  void take(const BakeEvent& event) const;

 private:
  void warn(const std::exception& error) const;

  const BakeSession& session_;
  std::filesystem::path path_;
};

}  // namespace gigabake
