#include "pipeline/cli/jobs.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <unistd.h>

#include "base/fail.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

namespace fs = std::filesystem;

namespace {

/// Whether the folder is still to be made; refused if it cannot be.
bool is_to_come(const std::string& folder) {
  std::error_code error;
  const fs::path plain = (fs::path(folder) / "").parent_path();  // without a slash at its end
  const fs::file_status status = fs::status(plain, error);
  if (fs::is_directory(status)) return false;
  if (fs::exists(status)) fail(ErrorCode::cannot_write, "{}: is not a folder", folder);
  const fs::path parent = plain.has_parent_path() ? plain.parent_path() / "" : fs::path("./");
  if (access(parent.c_str(), W_OK) != 0)
    fail(ErrorCode::cannot_write, "{}: cannot make the folder: {}", folder, std::strerror(errno));
  return true;
}

std::string joined(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

/// What an input is called in a folder. "scan.v2" has no extension that stands for a format.
std::string name_in_folder(const std::string& input, std::optional<Format> written) {
  fs::path name = fs::path(input).filename();
  const auto present = pipeline::io::format_of_extension(name);
  if (!written || present == written) return name.string();
  if (present) name.replace_extension();
  return fmt::format("{}.{}", name.string(), pipeline::io::name_of(*written));
}

/// The jobs of a folder, which may be one that is still to be made.
std::vector<Job> into_folder(const std::vector<std::string>& inputs, const std::string& folder,
                             std::optional<Format> written) {
  std::vector<Job> jobs = jobs_in_folder(inputs, folder, written);
  if (is_to_come(folder))
    for (Job& job : jobs) job.folder = folder;
  return jobs;
}

}  // namespace

std::vector<Job> jobs_in_folder(const std::vector<std::string>& inputs, const std::string& folder,
                                std::optional<Format> written) {
  std::map<std::string, std::string> taken;
  std::vector<Job> jobs;
  for (const std::string& input : inputs) {
    if (input == "-")
      fail(ErrorCode::usage,
           "standard input (-) cannot go into a folder: it has no name; give -o a file name");
    const std::string name = name_in_folder(input, written);
    const auto [it, is_new] = taken.emplace(name, input);
    if (!is_new)
      fail(ErrorCode::usage, "{} and {} would both be written to {}", it->second, input,
           joined(folder, name));
    jobs.push_back({input, joined(folder, name)});
  }
  return jobs;
}

std::vector<Job> plan_jobs(const std::vector<std::string>& arguments,
                           const std::optional<std::string>& output, std::optional<Format> written) {
  for (const std::string& argument : arguments)
    if (argument.empty()) fail(ErrorCode::usage, "a file name is empty");
  if (!output) {
    if (arguments.size() == 2) return {{arguments[0], arguments[1]}};
    fail(ErrorCode::usage,
         "{} given, but without -o exactly two are needed: IN OUT (with -o every one is an input)",
         arguments.empty()       ? "no file name"
         : arguments.size() == 1 ? "one file name"
                                 : fmt::format("{} file names", arguments.size()));
  }
  if (arguments.empty()) fail(ErrorCode::usage, "no input given");
  std::error_code error;
  const bool slash = !output->empty() && output->back() == '/';
  if (*output != "-" && (slash || fs::is_directory(*output, error)))
    return into_folder(arguments, *output, written);
  if (arguments.size() == 1) return {{arguments[0], *output}};
  if (fs::exists(*output, error))
    fail(ErrorCode::cannot_write, "{}: is not a folder, and there are several inputs", *output);
  // The name of a file, or a slip: whoever wants a folder called so writes the slash.
  if (*output == "-" || pipeline::io::format_of_extension(*output))
    fail(ErrorCode::usage, "several inputs need a folder{}",
         *output == "-" ? ", not standard output (-)" : ": " + *output + "/ if it is to be called so");
  return into_folder(arguments, *output, written);
}

int run_jobs(const std::vector<Job>& jobs, Console& console,
             const std::function<std::optional<Error>(const Job&)>& run) {
  std::vector<std::string> failed;
  std::optional<int> code;
  std::size_t done = 0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const Job& job = jobs[i];
    console.progress().start_job(i, jobs.size());
    const std::optional<Error> error = run(job);
    done += !error;
    if (!error) continue;
    failed.push_back(job.input);
    const bool reader_left =
        job.output == "-" && error->code == ErrorCode::cannot_write && stdout_reader_is_gone();
    if (!reader_left) console.error(error->message);
    code = !code || *code == exit_code(error->code) ? exit_code(error->code) : exit_code(ErrorCode::internal);
    if (error->code == ErrorCode::cancelled) {
      code = exit_code(ErrorCode::cancelled);
      break;
    }
  }
  if (jobs.size() > 1) {
    for (const std::string& input : failed) console.say(input + ": FAILED");
    console.say(fmt::format("{} of {} done", done, jobs.size()));
  }
  return code.value_or(0);
}

}  // namespace rfsmooth::cli
