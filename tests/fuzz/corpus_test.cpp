/// The corpus of the fuzz target `denoise`, replayed by every test run: what it once found stays found.
#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/fuzz/cloud_to_flow.h"

namespace rfsmooth::fuzz {
namespace {

TEST(Corpus, CloudsThroughMeshAndFlowAreReplayed) {
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(RFSMOOTH_CORPUS_DIR "/denoise")) {
    SCOPED_TRACE(entry.path());
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    cloud_to_flow(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());  // aborts on a finding
    ++seen;
  }
  EXPECT_GE(seen, 6u);
}

}  // namespace
}  // namespace rfsmooth::fuzz
