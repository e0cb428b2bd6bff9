/// rfsmooth man: manual pages in roff, from the commands' own tables. The build runs it and installs the
/// pages.
#include <fmt/format.h>

#include <rfsmooth/version.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"
#include "pipeline/cli/exit_code.h"
#include "pipeline/cli/options/help.h"
#include "pipeline/cli/options/suggest.h"

namespace rfsmooth::cli {

namespace {

/// Text that roff takes literally.
std::string escaped(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (line_start && (c == '.' || c == '\''))
      out += std::string("\\&") + c;
    else if (c == '\n')
      out += "\n.br\n";
    else
      out += c;
    line_start = c == '\n';
  }
  return out;
}

std::string page_head(const std::string& name, const std::string& summary) {
  std::string title = name;
  for (char& c : title)
    if (c >= 'a' && c <= 'z') c = char(c - 'a' + 'A');
  return fmt::format(".TH {} 1 \"\" \"rfsmooth {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n", escaped(title),
                     kVersion, escaped(name), escaped(summary));
}

std::string tagged(const std::string& heading, const std::string& text) {
  return fmt::format(".TP\n.B {}\n{}\n", escaped(heading), escaped(text));
}

std::string exit_status() {
  std::string out = ".SH EXIT STATUS\n";
  for (const ExitCode& e : kExitCodes) out += tagged(std::to_string(e.code), e.meaning);
  return out;
}

std::string page_of(const Command& command) {
  std::string out = page_head("rfsmooth-" + command.name, command.summary) + ".SH SYNOPSIS\n";
  for (const std::string& form : command.usage)
    out += fmt::format(".B rfsmooth {}\n{}\n.br\n", escaped(command.name), escaped(form));
  out += ".SH DESCRIPTION\n" + escaped(command.description) + "\n.SH OPTIONS\n";
  for (const CommandOption& o : command.options) {
    const std::string heading = option_heading(o);
    out += tagged(heading.substr(heading.find('-')), option_help(o));
  }
  return out + exit_status() + ".SH SEE ALSO\n.BR rfsmooth (1)\n";
}

std::string page_of_all(const std::vector<Command>& commands) {
  std::string out =
      page_head("rfsmooth", "take the noise out of 3-D scans") +
      ".SH SYNOPSIS\n.B rfsmooth\nCOMMAND [options] ...\n.SH DESCRIPTION\n"
      "rfsmooth takes a noisy 3\\-D scan and gives back the same cloud with the noise gone: every "
      "point, every field, the same order.\n.SH COMMANDS\n";
  for (const Command& c : commands)
    if (c.listed) out += tagged("rfsmooth-" + c.name + "(1)", c.summary);
  return out + exit_status();
}

std::string page(const std::vector<std::string>& arguments) {
  const std::vector<Command> commands = all_commands();
  if (arguments.empty()) return page_of_all(commands);
  std::vector<std::string> names;
  for (const Command& c : commands) {
    if (arguments.size() == 1 && arguments[0] == c.name) return page_of(c);
    names.push_back(c.name);
  }
  fail(ErrorCode::usage, "no manual page for '{}'{}", fmt::join(arguments, " "),
       did_you_mean(arguments[0], names));
}

}  // namespace

Command man_command() {
  return text_command(
      "man", "print a manual page (roff)", "[COMMAND]",
      "Prints the manual page of rfsmooth, or of one command: rfsmooth man denoise | man -l -", page);
}

}  // namespace rfsmooth::cli
