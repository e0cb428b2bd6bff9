#include "tests/fuzz/file_in_pieces.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rfsmooth::fuzz::file_in_pieces(data, size);
  return 0;
}
