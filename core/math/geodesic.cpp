#include "core/math/geodesic.h"

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>

namespace gigabake {

GeodesicPath::GeodesicPath(const std::vector<Geodetic>& vertices) {
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const Geodetic &a = vertices[i - 1], &b = vertices[i];
    Edge edge{a.latitude_deg, a.longitude_deg, 0, length_m_};
    double distance_m = 0, azimuth_at_end_deg = 0;
    GeographicLib::Geodesic::WGS84().Inverse(a.latitude_deg, a.longitude_deg, b.latitude_deg, b.longitude_deg,
                                             distance_m, edge.azimuth_deg, azimuth_at_end_deg);
    edges_.push_back(edge);
    length_m_ += distance_m;
  }
}

Geodetic GeodesicPath::position(double distance_m) const {
  const auto after = std::upper_bound(edges_.begin() + 1, edges_.end(), distance_m,
                                      [](double distance, const Edge& edge) { return distance < edge.begin_m; });
  const Edge& edge = *(after - 1);
  Geodetic p;
  GeographicLib::Geodesic::WGS84().Direct(edge.latitude_deg, edge.longitude_deg, edge.azimuth_deg,
                                          distance_m - edge.begin_m, p.latitude_deg, p.longitude_deg);
  return p;
}

}  // namespace gigabake
