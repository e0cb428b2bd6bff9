/// The corpus of the fuzz target `read_rows`, replayed by every test run: broken files are refused, whole
/// ones read.
#include "tests/fuzz/file_in_pieces.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

namespace rfsmooth::fuzz {
namespace {

TEST(Corpus, FilesReadInPiecesAreReplayed) {
  std::size_t whole = 0, broken = 0;
  for (const auto& entry : std::filesystem::directory_iterator(RFSMOOTH_CORPUS_DIR "/rows")) {
    SCOPED_TRACE(entry.path());
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    const bool read = file_in_pieces(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    EXPECT_EQ(read, entry.path().filename().string().rfind("broken_", 0) != 0);
    ++(read ? whole : broken);
  }
  EXPECT_GE(whole, 4u);
  EXPECT_GE(broken, 6u);
}

}  // namespace
}  // namespace rfsmooth::fuzz
