#include "pipeline/io/other_formats.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace rfsmooth::pipeline::io {

namespace {

constexpr const char *kPoints = "convert it to PLY first: CloudCompare, or pdal translate IN OUT.ply",
                     *kLaz =
                         "use the Python module with laspy and lazrs (python -m rfsmooth denoise in.laz "
                         "out.laz), or LAS and a converter: laszip, or pdal translate IN OUT",
                     *kMesh = "convert it to PLY first: MeshLab, Blender or CloudCompare",
                     *kScanner = "export it from the scanner's program as PLY or XYZ",
                     *kPacked = "unpack it first", *kNoPoints = "that holds no points",
                     *kArray = "save it as text, three columns x y z, in a file called .xyz";

constexpr OtherFormat kFormats[] = {
    {"LAZ", ".laz", "", kLaz, false, kLaz},
    {"E57", ".e57", "ASTM-E57", kPoints},
    {"OBJ", ".obj", "", kMesh, true},
    {"STL", ".stl", "solid ", kMesh, true},
    {"glTF", ".glb .gltf", "glTF", kMesh, true},
    {"FBX", ".fbx", "Kaydara FBX", kMesh, true},
    {"VTK", ".vtk .vtp .vtu", "# vtk DataFile", kMesh, true},
    {"Draco", ".drc", "DRACO", kMesh},
    {"USD", ".usd .usda .usdc .usdz", "", kMesh, true},
    {"X3D", ".x3d", "", kMesh, true},
    {"VRML", ".wrl", "#VRML", kMesh, true},
    {"Collada", ".dae", "", kMesh, true},
    {"3DS", ".3ds", "", kMesh},
    {"3MF", ".3mf", "", kMesh},
    {"PTX", ".ptx", "", kPoints, true},
    {"CloudCompare's BIN", "", "CCB2", "save it from CloudCompare as PLY"},
    {"raw binary", ".bin .dat .raw", "", kArray},
    {"a scanner's own format", ".ptg .fls .fws .rcp .rcs .zfs .zfc .rxp .rdbx .lsproj .tzf .cl3 .clr", "",
     kScanner},
    {"a ROS bag", ".bag", "#ROSBAG", "take the clouds out first: rosrun pcl_ros bag_to_pcd"},
    {"HDF5", ".h5 .hdf5", "\x89HDF", kArray},
    {"NumPy", ".npy .npz", "\x93NUMPY", kArray},
    {"gzip", ".gz .tgz", "\x1f\x8b", kPacked},
    {"bzip2", ".bz2", "BZh", kPacked},
    {"xz", ".xz",
     "\xfd"
     "7zXZ",
     kPacked},
    {"Zstandard", ".zst", "\x28\xb5\x2f\xfd", kPacked},
    {"7-Zip", ".7z", "7z\xbc\xaf", kPacked},
    {"ZIP", ".zip", "PK\x03\x04", kPacked},
    {"a picture", ".png", "\x89PNG", kNoPoints},
    {"a picture", ".jpg .jpeg", "\xff\xd8\xff", kNoPoints},
    {"PDF", ".pdf", "%PDF", kNoPoints},
};

bool has_extension(const OtherFormat& format, const std::string& extension) {
  const std::string all = std::string(format.extensions) + ' ';
  return !extension.empty() && all.find(extension + ' ') != std::string::npos;
}

}  // namespace

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

const OtherFormat* other_format_of_extension(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  for (const OtherFormat& format : kFormats)
    if (has_extension(format, extension)) return &format;
  return nullptr;
}

const OtherFormat* other_format_of_bytes(std::string_view first_bytes) {
  for (const OtherFormat& format : kFormats) {
    const std::string_view magic = format.magic;
    if (!magic.empty() && first_bytes.substr(0, magic.size()) == magic) return &format;
  }
  return nullptr;
}

}  // namespace rfsmooth::pipeline::io
