/// Jobs: which input goes to which output, and running them one after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/cloud_file.h>
#include <rfsmooth/result.h>

#include "pipeline/cli/console/console.h"

namespace rfsmooth::cli {

struct Job {
  std::string input;   ///< a path, or "-" for standard input
  std::string output;  ///< a path, or "-" for standard output
  /// That of the output, if -o names it and it is not there yet: to be made before anything is written.
  std::string folder = {};
};

/// A job for each input, which keeps its name in the folder, with the extension of `written` where that is
/// another format. \throw Failure (usage) for two inputs with the same output name, and for
/// standard input.
std::vector<Job> jobs_in_folder(const std::vector<std::string>& inputs, const std::string& folder,
                                std::optional<Format> written = std::nullopt);

/// Without `output` there must be two arguments, IN and OUT. With it every argument is an input. Then
/// `output` is a file for one input, or a folder for any number: one that exists, or a name that ends in '/',
/// or for several inputs any name that is not a cloud file's. Makes nothing. \throw Failure: usage (wrong
/// count, two inputs with the same output name), cannot_write (a file is in the folder's place, or the folder
/// cannot be made).
/// \param written the format of all outputs, whose extension their names in a folder get; none: each as its
/// input, and called as that is
std::vector<Job> plan_jobs(const std::vector<std::string>& arguments,
                           const std::optional<std::string>& output,
                           std::optional<Format> written = std::nullopt);

/// Runs every job, also after errors, and stops at a cancel. `run` returns the error, if any. After several
/// jobs the failed ones are listed again on stderr. \return 0 without errors; 130 after a cancel; the code of
/// the errors if they share one; else 1.
int run_jobs(const std::vector<Job>& jobs, Console& console,
             const std::function<std::optional<Error>(const Job&)>& run);

}  // namespace rfsmooth::cli
