#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "pipeline/cli/commands/reconstruct_command.h"

namespace rfsmooth::cli {

int become_program(const std::string& name, const std::vector<std::string>& arguments) {
  std::vector<char*> argv;
  std::string own_name = name;
  argv.push_back(own_name.data());
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  std::error_code unknown;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (!unknown) execv((self.parent_path() / name).c_str(), argv.data());
  if (unknown || errno == ENOENT) execvp(name.c_str(), argv.data());
  if (errno == ENOENT)
    throw Failure({ErrorCode::not_installed,
                   fmt::format("the program {0} is not installed; it comes with the package {0}, or from a "
                               "build that finds Open3D or CGAL",
                               name)});
  throw Failure({ErrorCode::not_installed,
                 fmt::format("the program {} cannot be started: {}", name, std::strerror(errno))});
}

}  // namespace rfsmooth::cli
