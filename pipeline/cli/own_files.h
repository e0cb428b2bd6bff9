/// Protects clouds that others wrote from being replaced by --force.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/cli/jobs.h"

namespace rfsmooth::cli {

/// Marks a file just written as the command's own, in its extended attributes, so that its bytes do not
/// change. The mark holds size and time of writing; it is void once another program changes the file. Does
/// nothing if the file system has no extended attributes.
void mark_as_own(const std::string& path);

/// Refuses an OUT that is a cloud without a valid mark, because `*.ply` in a folder with two scans passes the
/// second one as OUT. `named`: the value of -o. OUT may be replaced if -o names it, or if it is spelled
/// exactly as IN. In a folder named by -o only the inputs themselves are protected. \throw Failure
/// (cannot_write).
void need_own_target(const Job& job, const std::optional<std::string>& named);

/// The same where many inputs are one job: refuses an output that is any of them, or a cloud without a valid
/// mark. \throw Failure (cannot_write).
void need_own_target(const std::vector<std::string>& inputs, const std::string& output);

/// Refuses, before any work, what a file that is no cloud ("report", "picture") could not be written to:
/// standard output, a file that exists, without `force`, and with it a cloud. \throw Failure (usage,
/// cannot_write).
void check_no_cloud_target(const std::string& path, bool force, const char* what);

}  // namespace rfsmooth::cli
