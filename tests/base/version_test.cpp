#include <string>

#include <gtest/gtest.h>

#include <rfsmooth/version.h>

TEST(Version, TheWordAndTheNumbersAgree) {
  EXPECT_EQ(rfsmooth::kVersion, std::to_string(RFSMOOTH_VERSION_MAJOR) + "." +
                                    std::to_string(RFSMOOTH_VERSION_MINOR) + "." +
                                    std::to_string(RFSMOOTH_VERSION_PATCH));
}
