#include "tests/fuzz/cloud_to_flow.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rfsmooth::fuzz::cloud_to_flow(data, size);
  return 0;
}
