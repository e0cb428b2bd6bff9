// What the pages say of the flows is what the registry says.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/run_command.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr const char* kHow = "run: bash clouds/gallery.sh";

std::string text_of(const std::string& name) {
  std::ifstream file(std::filesystem::path(RFSMOOTH_SOURCE) / name);
  EXPECT_TRUE(file.good()) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Readme, ItsTableOfFlowsIsTheRegistrys) {
  const Ran table = rfsmooth({"flows", "--markdown"});
  ASSERT_EQ(table.code, 0);
  EXPECT_THAT(text_of("README.md"), HasSubstr("<!-- flows -->\n" + table.out + "<!-- end of flows -->\n"))
      << kHow;
}

TEST(Readme, TheGalleryShowsEveryFlowAndItsPicturesAreThere) {
  const std::string page = text_of("clouds/gallery.md");
  for (const auto& flow : nlohmann::json::parse(rfsmooth({"flows", "--json"}).out)) {
    const std::string name = flow["name"];
    EXPECT_THAT(page, HasSubstr("**" + name + "**: " + flow["summary"].get<std::string>())) << kHow;
    const std::string picture = "pictures/flows/" + name + ".png";
    if (page.find(picture) != std::string::npos) {
      EXPECT_THAT(text_of("clouds/" + picture), HasSubstr("PNG")) << kHow;
    }
  }
}

}  // namespace
}  // namespace rfsmooth::test
