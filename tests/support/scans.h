/// Real scans for tests: the crops that come with the sources (clouds/README.md says what they are) and,
/// where the build was given a folder of whole scans (RFSMOOTH_SCANS_DIR), those. A stranger's build has the
/// crops.
#pragma once

#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace rfsmooth::test {

/// Organised: the floor of a room by a Kinect, its depth in steps; the edge of a box on a table by an RGB-D
/// camera, each point with a label. Not organised: a building by a laser, noisy all over.
inline constexpr const char *kFloorCrop = RFSMOOTH_CROPS_DIR "/kinect_floor.pcd",
                            *kBoxCrop = RFSMOOTH_CROPS_DIR "/rgbd_box.pcd",
                            *kBuildingCrop = RFSMOOTH_CROPS_DIR "/laser_building.pcd";

/// Of these files of the folder of whole scans the paths; none if no folder was given. A file that is missing
/// in a folder that was given is an error of the test that reads it.
inline std::vector<std::string> whole_scans(const std::vector<std::string>& files) {
  const std::filesystem::path folder = RFSMOOTH_SCANS_DIR;
  std::vector<std::string> paths;
  if (!folder.empty())
    for (const std::string& file : files) paths.push_back((folder / file).string());
  return paths;
}

/// The crops and those of the whole scans.
inline std::vector<std::string> crops_and(const std::vector<std::string>& files) {
  std::vector<std::string> paths = {kFloorCrop, kBoxCrop, kBuildingCrop};
  const std::vector<std::string> whole = whole_scans(files);
  paths.insert(paths.end(), whole.begin(), whole.end());
  return paths;
}

/// The file's name as that of a test.
inline std::string test_name(const std::string& path) {
  std::string name = std::filesystem::path(path).stem().string();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

inline std::string name_of_scan(const testing::TestParamInfo<std::string>& test) {
  return test_name(test.param);
}

}  // namespace rfsmooth::test
