// Stubs of the CUDA first hits for builds without nvcc.
#ifndef GIGABAKE_HAS_CUDA
#include "kernels/cuda/baker.h"
#include "query/first_hit/first_hit_device.h"
#include "query/first_hit/query_device.h"

namespace gigabake::kernels {

class CudaFirstHits::Impl {};

CudaFirstHits::CudaFirstHits(int, const FirstHitView&) { throw CudaFailure(cuda_devices().reason); }
CudaFirstHits::~CudaFirstHits() = default;

// Unreachable: the constructor throws, so no object exists.
void CudaFirstHits::upload(Span<const FirstHitRay>) { throw CudaFailure(cuda_devices().reason); }
double CudaFirstHits::cast(const FirstHitCamera&, bool) { throw CudaFailure(cuda_devices().reason); }
double CudaFirstHits::cast(bool) { throw CudaFailure(cuda_devices().reason); }
std::vector<FirstHit> CudaFirstHits::hits() const { throw CudaFailure(cuda_devices().reason); }
std::vector<VoxelAttributes> CudaFirstHits::attributes() const { throw CudaFailure(cuda_devices().reason); }
std::uint64_t CudaFirstHits::device_bytes() const { throw CudaFailure(cuda_devices().reason); }

class CudaQuery::Impl {};

CudaQuery::CudaQuery(int, const QueryCells&, const QueryLevels&, const VoxelBox&, std::uint64_t) {
  throw CudaFailure(cuda_devices().reason);
}
CudaQuery::~CudaQuery() = default;
void CudaQuery::add_tree(std::uint32_t, std::uint32_t, const ShardTree&) { throw CudaFailure(cuda_devices().reason); }
void CudaQuery::cast(Span<const QueryRay>, Span<QueryTraversal>) { throw CudaFailure(cuda_devices().reason); }
std::uint64_t CudaQuery::device_bytes() const { throw CudaFailure(cuda_devices().reason); }

}  // namespace gigabake::kernels
#endif
