/// A folder of its own for every test, with files to put in and take out.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/cli/support/run_command.h"

namespace rfsmooth::test {

class InFolder : public ::testing::Test {
 protected:
  InFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rfsmooth-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = name;
  }
  ~InFolder() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// Full path of `name` in the folder.
  std::string at(const std::string& name) const { return (std::filesystem::path(folder_) / name).string(); }

  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(at(name), std::ios::binary) << bytes;
    return at(name);
  }
  std::string take(const std::string& name) const {
    std::ifstream file(at(name), std::ios::binary);
    EXPECT_TRUE(file.good()) << "no file " << name;
    return {std::istreambuf_iterator<char>(file), {}};
  }
  bool there(const std::string& name) const { return std::filesystem::exists(at(name)); }

  /// Names of everything in the folder, sorted.
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  /// Runs rfsmooth in the folder.
  Ran run(const std::vector<std::string>& arguments, RunSetup setup = {}) const {
    setup.folder = folder_;
    return rfsmooth(arguments, setup);
  }

 private:
  std::string folder_;
};

}  // namespace rfsmooth::test
