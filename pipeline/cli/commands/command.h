/// A sub-command of rfsmooth: what help says of it, its options, and what it does. One file per sub-command.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <rfsmooth/cloud_file.h>

#include "pipeline/cli/console/progress.h"
#include "pipeline/cli/options/option.h"

namespace rfsmooth {
struct StageTime;
namespace pipeline::io {
struct Cloud;
}
}  // namespace rfsmooth

namespace rfsmooth::cli {

class Console;
struct Job;

/// What was typed, taken apart but not yet believed.
struct Invocation {
  std::vector<std::string> arguments;                        ///< positional ones, in order
  std::vector<std::pair<std::string, std::string>> options;  ///< name and text, in order
  bool short_help = false;                                   ///< -h, --help
  bool long_help = false;                                    ///< --help-all
  bool version = false;
};

/// What goes with a cloud that is worked on: where it comes from and goes to, and where to say what is done.
struct CloudTask {
  const Job& job;
  const Context& context;
  Console& console;
  std::vector<StageTime>& stages;  ///< gets those of the work
  nlohmann::ordered_json& entry;   ///< of the report: gets "options", "counts", ...
};

/// What a sub-command does with one cloud: changes it, or puts another in its place. \return what it did in
/// at most three short lines, the most telling ones first. \throw Failure.
using CloudWork = std::function<std::string(pipeline::io::Cloud& cloud, const CloudTask& task)>;

/// A file that stands beside the cloud: a page, a trace.
struct FileBeside {
  std::string option;  ///< the one that names it: "--html"
  const char* what;    ///< in a word: "page"
  std::string path;
};

/// A sub-command that turns one cloud into another, wherever that comes from: a file, or an array in Python.
/// To be called once every option has its value.
struct OnCloud {
  /// Refuses options that cannot be meant. \throw Failure (usage).
  std::function<void(const Invocation&)> check;
  std::function<std::vector<StageShare>()> stages;  ///< those of reading and working
  CloudWork work;
  /// Writes what stands beside the cloud (a page, a trace), which `work` has made ready; empty: nothing does.
  /// Called once the cloud is there, and not stopped any more. \throw Failure.
  std::function<void(Console&)> beside = {};
  /// The format of what `work` makes; none: that of the input.
  std::optional<Format> makes = std::nullopt;
  /// The files that `beside` writes, as asked for; empty: none.
  std::function<std::vector<FileBeside>()> files_beside = {};
  /// What a file of that format and encoding has no room for, in words, of what `work` will make of the
  /// cloud, as far as it is known before the work. \throw Failure.
  std::function<std::vector<std::string>(const pipeline::io::Cloud&, Format, Encoding, const Context&)>
      will_lose = {};
};

struct Command {
  std::string name;
  std::string summary;             ///< one line
  std::vector<std::string> usage;  ///< what follows the name, one per form: "[options] IN OUT"
  std::string description;         ///< paragraphs for --help-all and the man page
  std::vector<CommandOption> options;
  std::vector<std::string> everyday;          ///< what --help shows, in this order; empty: all of them
  std::vector<std::string> first_words = {};  ///< one of which comes first, for completion; empty: a file
  /// \return the exit code. \throw Failure. `invocation.options` are already assigned when it is called.
  std::function<int(const Invocation&)> run;
  OnCloud on_cloud;    ///< empty where it does something else
  bool listed = true;  ///< shown in the overview of `rfsmooth --help`
};

Command denoise_command();
Command mesh_command();
Command smooth_mesh_command();
Command info_command();
Command compare_command();
Command report_command();
Command flows_command();
Command tiles_command();
Command man_command();
Command completion_command();

/// A command that prints the text made of its arguments and is not in the overview: the build runs it and
/// installs the text.
Command text_command(std::string name, std::string summary, std::string usage, std::string description,
                     std::function<std::string(const std::vector<std::string>& arguments)> text);

/// All of them, in the order of the overview.
std::vector<Command> all_commands();

/// The one called `name`; null if there is none.
const Command* find_command(const std::vector<Command>& commands, std::string_view name);

}  // namespace rfsmooth::cli
