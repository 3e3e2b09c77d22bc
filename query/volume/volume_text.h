/// A volume as one row of CSV or one JSON object (docs/schemas/volume-1.json).
#pragma once

#include <string>

#include "query/query_text.h"
#include "query/volume/volume.h"

namespace gigabake {

/// The reference of a volume, as the user stated it.
struct VolumeReference {
  std::optional<double> above_m;
  std::string against;  ///< the path of the other scene; empty if above_m has a value
};

/// Returns the text. Cut, fill and their errors are empty (CSV) or null if columns are missing. Volumes are printed
/// with a resolution of a tenth of a voxel or finer.
/// Errors  UsageError: a format other than CSV and JSON.
std::string volume_text(const Volume& volume, const VolumeReference& reference, QueryFormat format);

/// Returns "1234.5 ± 12.0 m³ cut, 0.0 ± 0.3 m³ fill".
/// Range   No column is missing.
std::string volume_summary(const Volume& volume);

/// Throws the errors of volume_text() before the volume is measured.
void expect_volume_format(QueryFormat format);

}  // namespace gigabake
