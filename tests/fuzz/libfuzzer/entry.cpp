// A fuzzer of one reader. GIGABAKE_READER is a function of tests/fuzz/readers.h.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/judge.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string fault = gigabake::fuzz::fault_of(gigabake::fuzz::GIGABAKE_READER, {data, size});
  if (!fault.empty()) {
    std::fprintf(stderr, "%s\n", fault.c_str());
    std::abort();
  }
  return 0;
}
