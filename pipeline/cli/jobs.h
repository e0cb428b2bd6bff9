/// Which inputs go to which outputs, and running them one after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/result.h>

#include "pipeline/cli/console/console.h"

namespace rfsmooth::cli {

struct Job {
  std::string input;   ///< a path, or "-" for standard input
  std::string output;  ///< a path, or "-" for standard output
};

/// Without `output` exactly two arguments, IN and OUT; with it every argument is an input and `output` is a
/// file for one input or a folder for any number: one that exists or ends in '/', and for several inputs any
/// name that is not a cloud file's. It is made if need be.
/// \throw Failure: usage (wrong count, two inputs that would get the same name), cannot_write (a folder is
/// needed and a file is in its place, or it cannot be made).
std::vector<Job> plan_jobs(const std::vector<std::string>& arguments,
                           const std::optional<std::string>& output);

/// Runs every job, going on after an error; after several jobs stderr has the failed ones once more. Stops at
/// a cancel. `run` returns what went wrong, if anything did. \return 0; the code of the error if all failures
/// share one; else 1.
int run_jobs(const std::vector<Job>& jobs, Console& console,
             const std::function<std::optional<Error>(const Job&)>& run);

}  // namespace rfsmooth::cli
