/// What --force may replace: nothing that somebody else's work is in.
#pragma once

#include <optional>
#include <string>

#include "pipeline/cli/jobs.h"

namespace rfsmooth::cli {

/// Marks a file that was just written as the command's own, in its extended attributes: no byte of it
/// changes. The mark holds size and time of writing and counts no more once another program has changed the
/// file. Silent where the file system keeps no attributes.
void mark_as_own(const std::string& path);

/// Whether a file carries a valid mark.
bool is_own(const std::string& path);

/// Whether a regular file is there that begins as a PLY, PCD, OFF or LAS file does, or that reads as points.
bool holds_cloud(const std::string& path);

/// Refuses an OUT that is a cloud without the mark: `*.ply` in a folder of two scans names the second one.
/// `named` is what -o says. OUT is meant if that names it, or if it is written as IN is, letter by letter; in
/// a folder that -o names, only the inputs themselves are kept. \throw Failure (cannot_write).
void need_own_target(const Job& job, const std::optional<std::string>& named);

/// Refuses a file that is no cloud, a report say, in the place of one. \throw Failure (cannot_write).
void need_no_cloud(const std::string& path, const char* what);

}  // namespace rfsmooth::cli
