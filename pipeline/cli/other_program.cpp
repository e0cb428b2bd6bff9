#include "pipeline/cli/other_program.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "base/fail.h"
#include "pipeline/cli/options/text_values.h"

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
    fail(ErrorCode::not_installed, "the program {0} is not installed; it comes with the package {1}", name,
         name == "rfsmooth-reconstruct" ? name + ", or from a build that finds Open3D or CGAL" : "rfsmooth");
  fail(ErrorCode::not_installed, "the program {} cannot be started: {}", name, std::strerror(errno));
}

std::vector<std::string> as_typed(const Invocation& typed, const std::vector<CommandOption>& options) {
  std::vector<std::string> words;
  for (const auto& [name, text] : typed.options) {
    const bool flag = find_option(options, name)->kind == ValueKind::flag;
    std::string word = flag && text != "true" ? "--no-" : "--";
    word += name;
    if (!flag) word.append("=").append(text);
    words.push_back(std::move(word));
  }
  const auto like_option = [](const std::string& word) { return word.size() > 1 && word[0] == '-'; };
  if (std::any_of(typed.arguments.begin(), typed.arguments.end(), like_option)) words.emplace_back("--");
  words.insert(words.end(), typed.arguments.begin(), typed.arguments.end());
  return words;
}

std::string command_line(const std::string& command, const Invocation& typed,
                         const std::vector<CommandOption>& options) {
  std::string line = "rfsmooth " + command;
  for (const std::string& word : as_typed(typed, options)) line += ' ' + shell_quoted(word);
  return line;
}

}  // namespace rfsmooth::cli
