// What the pages say of the flows is what the registry says.
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/support/run_command.h"
#include "tests/support/sanitized.h"

using ::testing::HasSubstr;

namespace rfsmooth::test {
namespace {

constexpr const char* kHow = "run: bash clouds/gallery.sh";

std::string text_of(const std::string& name) {
  std::ifstream file(std::filesystem::path(RFSMOOTH_SOURCE) / name);
  EXPECT_TRUE(file.good()) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Readme, TheTableOfFlowsIsTheRegistrys) {
  const Ran table = rfsmooth({"flows", "--markdown"});
  ASSERT_EQ(table.code, 0);
  EXPECT_THAT(text_of("docs/FLOWS.md"), HasSubstr("<!-- flows -->\n" + table.out + "<!-- end of flows -->\n"))
      << kHow;
}

/// The links of a page to files of the project: [words](file) or [words](file#heading).
std::vector<std::string> files_linked_in(const std::string& text) {
  static const std::regex kLink("\\]\\(([^):#]+)(#[^)]*)?\\)");
  std::vector<std::string> files;
  for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it)
    files.push_back((*it)[1]);
  return files;
}

/// All pages of the project. No part of it: hidden folders, and those that something was built or written in.
std::vector<std::filesystem::path> all_pages() {
  using Walk = std::filesystem::recursive_directory_iterator;
  static const std::set<std::string> kPassedOver = {"build", "out"};
  std::vector<std::filesystem::path> found;
  for (Walk it(RFSMOOTH_SOURCE); it != Walk(); ++it) {
    const std::string name = it->path().filename().string();
    if (it->is_directory() && (name.front() == '.' || kPassedOver.count(name) > 0))
      it.disable_recursion_pending();
    else if (it->path().extension() == ".md")
      found.push_back(it->path());
  }
  return found;
}

TEST(Readme, LinksOfThePagesLeadToFiles) {
  std::size_t seen = 0;
  for (const std::filesystem::path& page : all_pages())
    for (const std::string& file : files_linked_in(text_of(page))) {
      EXPECT_TRUE(std::filesystem::exists(page.parent_path() / file)) << page << ": " << file;
      ++seen;
    }
  EXPECT_GE(seen, 60u);
}

TEST(Readme, TheGlossaryNamesHeadersThatExist) {
  std::set<std::string> headers;
  for (const char* room : {"base", "include", "rfs_mesh", "smoothing", "pipeline"})
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(RFSMOOTH_SOURCE) / room))
      headers.insert(entry.path().filename().string());
  const std::string page = text_of("docs/GLOSSARY.md");
  static const std::regex kHeader("`([a-z0-9_]+\\.h)`");
  std::size_t seen = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), kHeader), end; it != end; ++it, ++seen)
    EXPECT_EQ(headers.count((*it)[1]), 1u) << (*it)[1];
  EXPECT_GE(seen, 50u);
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

/// The words in backticks that look like a test's name: Suite.Name.
std::vector<std::string> tests_named_in(const std::string& text) {
  static const std::regex kName("`([A-Z][A-Za-z]*\\.[A-Z][A-Za-z]*)`");
  std::vector<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), kName), end; it != end; ++it)
    names.push_back((*it)[1]);
  return names;
}

TEST(Readme, EveryPromiseNamesTestsThatExist) {
  if (kSanitized) GTEST_SKIP() << "with the sanitizers only the core's tests are built";
  const Ran list = run_program("ctest", {"-N", "--test-dir", RFSMOOTH_BINARY});
  ASSERT_EQ(list.code, 0) << list.err;
  const std::string page = text_of("docs/GUARANTEES.md");
  std::size_t promises = 0;
  for (std::size_t at = page.find("\n- "); at != std::string::npos; ++promises) {
    const std::size_t next = page.find("\n- ", at + 1);
    const std::string promise = page.substr(at, next - at);
    at = next;
    const auto names = tests_named_in(promise);
    EXPECT_FALSE(names.empty()) << "no test keeps this promise:" << promise;
    for (const std::string& name : names)
      // "Test #7: Suite.Name" or "Test #7: Prefix/Suite.Name/parameter"
      EXPECT_TRUE(std::regex_search(list.out, std::regex("[ /]" + name + "(/|\\s|$)"))) << "no test " << name;
  }
  EXPECT_GE(promises, 15u);
}

}  // namespace
}  // namespace rfsmooth::test
