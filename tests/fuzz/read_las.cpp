#include "tests/fuzz/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return rfsmooth::fuzz::read_write_read(rfsmooth::pipeline::io::Format::las, data, size);
}
