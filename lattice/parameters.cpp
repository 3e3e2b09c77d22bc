#include "lattice/parameters.h"

#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "lattice/error.h"

namespace gigabake {

using OrderedJson = nlohmann::ordered_json;

// Found by argument-dependent lookup, which does not look into an unnamed namespace.
NLOHMANN_JSON_SERIALIZE_ENUM(SurfaceRule, {{SurfaceRule::area, "area"},
                                           {SurfaceRule::conservative, "conservative"},
                                           {SurfaceRule::thin, "thin"}})
NLOHMANN_JSON_SERIALIZE_ENUM(MipFilter, {{MipFilter::coverage, "coverage"},
                                         {MipFilter::thesis, "thesis"},
                                         {MipFilter::box, "box"}})
NLOHMANN_JSON_SERIALIZE_ENUM(Codec, {{Codec::lz4, "lz4"}, {Codec::deflate, "deflate"}})

namespace {

/// The library takes an unknown name for the first one.
template <class Enum>
void get_named(const OrderedJson& j, const char* key, Enum& value) {
  j.at(key).get_to(value);
  if (OrderedJson(value) != j.at(key))
    throw InputError("parameters", key, "has a value that is unknown; a newer gigabake may have written it");
}

}  // namespace

bool has_facing(const BakeParameters& p) { return p.facing && p.mip == MipFilter::coverage; }

std::string to_json(const BakeParameters& p) {
  OrderedJson j;
  j["voxel_size_m"] = p.voxel_size_m;
  j["lattice_origin_m"] = p.lattice_origin_m;
  j["cell_voxels"] = p.cell_voxels;
  j["surface"] = p.surface;
  j["mip"] = p.mip;
  j["normals"] = p.normals;
  j["max_error"] = p.max_error;
  j["codec"] = p.codec;
  // Only where it was declined: what was baked before one could decline it keeps its text, and its fingerprints.
  if (!p.facing) j["facing"] = false;
  return j.dump();
}

BakeParameters parameters_from_json(const std::string& json) {
  BakeParameters p;
  try {
    const OrderedJson j = OrderedJson::parse(json);
    j.at("voxel_size_m").get_to(p.voxel_size_m);
    j.at("lattice_origin_m").get_to(p.lattice_origin_m);
    j.at("cell_voxels").get_to(p.cell_voxels);
    get_named(j, "surface", p.surface);
    get_named(j, "mip", p.mip);
    j.at("normals").get_to(p.normals);
    // Scenes of version 1 say nothing of what came after them.
    p.codec = Codec::lz4;
    if (j.contains("max_error")) j.at("max_error").get_to(p.max_error);
    if (j.contains("codec")) get_named(j, "codec", p.codec);
    if (j.contains("facing")) j.at("facing").get_to(p.facing);
  } catch (const nlohmann::json::exception&) {
    throw InputError("parameters", "", "expected a JSON object with the parameters of a bake, as gigabake writes it");
  }
  check(p);
  return p;
}

void check(const BakeParameters& p) {
  if (!(p.voxel_size_m >= 1e-6 && p.voxel_size_m <= 1e6))
    throw UsageError(fmt::format("--voxel-size: expected 1e-6 to 1e6 metres, got {:g}", p.voxel_size_m));
  if (!std::has_single_bit(p.cell_voxels) || p.cell_voxels < 8 || p.cell_voxels > 8192)
    throw UsageError("--cell-voxels: expected a power of two from 8 to 8192, got " + std::to_string(p.cell_voxels));
  if (p.max_error > 127)
    throw UsageError("--max-error: expected 0 to 127 codes of 255, got " + std::to_string(p.max_error));
  for (const double x : p.lattice_origin_m)
    if (!std::isfinite(x)) throw UsageError("--lattice-origin: expected three finite numbers in metres");
}

}  // namespace gigabake
