/// A loop over ranges on threads of the caller's choice: a writer of shards loops some hundred times a cell, and
/// threads that are made for each loop would cost it more than they bring.
#pragma once

#include <cstddef>
#include <functional>

namespace gigabake {

/// Runs body(begin, end) over [0, count) in ranges of `grain`, in no particular order; the first exception thrown by a
/// body is rethrown.
using ParallelLoop = std::function<void(std::size_t count, std::size_t grain,
                                        const std::function<void(std::size_t begin, std::size_t end)>& body)>;

/// On short-lived threads (parallel.h); with one, in the caller's own.
ParallelLoop on_threads(int threads);

}  // namespace gigabake
