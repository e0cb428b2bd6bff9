/// Which inputs go to which outputs, and running them one after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <rfsmooth/result.h>

#include "pipeline/cli/console.h"

namespace rfsmooth::cli {

struct Job {
  std::string input;   ///< a path, or "-" for standard input
  std::string output;  ///< a path, or "-" for standard output
};

/// Without `output` exactly two arguments, IN and OUT; with it every argument is an input and `output` is a
/// file for one input or a folder (existing, or ending in '/': then it is made) for any number.
/// \throw Failure: usage (wrong count, two inputs that would get the same name), cannot_write (a folder is
/// needed and a file is in its place, or it cannot be made).
std::vector<Job> plan_jobs(const std::vector<std::string>& arguments,
                           const std::optional<std::string>& output);

/// What one job says in the table at the end.
struct JobOutcome {
  std::optional<Error> error;
  std::string summary;  ///< "100000 points, largest move 0.012, 3.4 s"
};

/// Runs every job, going on after an error; several jobs end in a table on stderr. Stops at a cancel.
/// \return 0; the code of the error if all failures share one; else 1.
int run_jobs(const std::vector<Job>& jobs, Console& console,
             const std::function<JobOutcome(const Job&)>& run);

}  // namespace rfsmooth::cli
