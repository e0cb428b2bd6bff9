/// Options of every sub-command with files: the output, report, config.
#pragma once

#include <optional>
#include <string>

#include <rfsmooth/options.h>

namespace rfsmooth::cli {

struct FileOptions {
  std::optional<std::string> output;
  std::optional<std::string> format;
  std::optional<std::string> encoding;
  bool force = false;
  bool drop_unsupported = false;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"output", "write here: a file for one input, a folder for many", "file"}, self.output);
    OptionInfo format{"format", "format of the output; auto: by the output's extension, else as the input",
                      ""};
    format.choices = {"ply", "pcd", "xyz", "off", "las"};
    visit(format, self.format);
    OptionInfo encoding{"encoding", "how values are stored in the output; auto: as in the input", ""};
    encoding.choices = {"ascii", "binary", "binary_big_endian", "binary_compressed"};
    visit(encoding, self.encoding);
    visit(OptionInfo{"force", "replace existing files", ""}, self.force);
    visit(OptionInfo{"drop-unsupported", "leave out what the output format cannot hold, with a warning", ""},
          self.drop_unsupported);
  }
};

struct RunOptions {
  std::optional<std::string> report;
  std::optional<std::string> config;

  template <class Self, class Visit>
  static void describe(Self& self, Visit&& visit) {
    visit(OptionInfo{"report", "write what was done as JSON (- for standard output)", "file"}, self.report);
    visit(OptionInfo{"config",
                     "take options (and files, if none are given) from a report or a JSON object of "
                     "options; options on the command line win",
                     "file"},
          self.config);
  }
};

}  // namespace rfsmooth::cli
