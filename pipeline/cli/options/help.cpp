#include "pipeline/cli/options/help.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/cli/exit_code.h"

namespace rfsmooth::cli {

namespace {

constexpr std::size_t kWidth = 100, kColumn = 26;

/// `text` broken at spaces so that no line is wider than kWidth, continued lines indented.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::string out;
  std::size_t column = indent;
  for (std::size_t begin = 0; begin < text.size();) {
    if (text[begin] == '\n') {
      out += '\n' + std::string(indent, ' ');
      column = indent;
      ++begin;
      continue;
    }
    const std::size_t end = std::min(text.find_first_of(" \n", begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    if (column > indent && column + 1 + word.size() > kWidth) {
      out += '\n' + std::string(indent, ' ');
      column = indent;
    }
    if (column > indent) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
    begin = end + (end < text.size() && text[end] == ' ' ? 1 : 0);
  }
  return out;
}

std::string entry(const std::string& heading, const std::string& text) {
  std::string line = "  " + heading;
  if (line.size() + 2 > kColumn)
    line += '\n' + std::string(kColumn, ' ');
  else
    line += std::string(kColumn - line.size(), ' ');
  return line + wrapped(text, kColumn) + '\n';
}

std::vector<CommandOption> everyday_options(const Command& command) {
  if (command.everyday.empty()) return command.options;
  std::vector<CommandOption> chosen;
  for (const std::string& name : command.everyday)
    if (const CommandOption* const o = find_option(command.options, name)) chosen.push_back(*o);
  return chosen;
}

}  // namespace

std::string option_heading(const CommandOption& option) {
  std::string heading = option.short_name ? fmt::format("-{}, ", option.short_name) : "    ";
  heading += fmt::format("{}", fmt::join(typed_names(option), ", "));
  const std::string value = value_name(option);
  return value.empty() ? heading : heading + ' ' + value;
}

std::string option_help(const CommandOption& option) {
  std::vector<std::string> limits;
  if (!option.choices.empty()) limits.push_back(fmt::format("one of {}", fmt::join(option.choices, ", ")));
  if (!option.unit.empty()) limits.push_back(option.unit);
  if (!option.range.empty()) limits.push_back(option.range);
  if (option.kind != ValueKind::flag && !option.default_text.empty())
    limits.push_back("default " + option.default_text);
  const std::string help = (option.on_by_default ? "do not " : "") + option.help;
  return limits.empty() ? help : fmt::format("{} ({})", help, fmt::join(limits, "; "));
}

std::string overview(const std::vector<Command>& commands, bool complete) {
  std::string out =
      "rfsmooth takes a noisy 3-D scan and gives back the same cloud with the noise gone.\n\n"
      "usage: rfsmooth COMMAND [options] ...\n\ncommands:\n";
  for (const Command& c : commands)
    if (c.listed || complete) out += entry(c.name, c.summary);
  out += "\noptions:\n";
  out += entry("-h, --help", "this page; after a command: its everyday options");
  out += entry("--help-all", "everything: after a command all its options, and the exit codes");
  out += entry("--version", "print the version");
  if (complete) {
    out += "\nexit codes:\n";
    for (const ExitCode& e : kExitCodes) out += entry(std::to_string(e.code), e.meaning);
  }
  out += "\nFor one command: rfsmooth COMMAND --help\n";
  return out;
}

std::string help_of(const Command& command, bool complete) {
  std::string out = fmt::format("rfsmooth {}: {}\n\n", command.name, command.summary);
  const char* lead = "usage: ";
  for (const std::string& form : command.usage) {
    out += fmt::format("{}rfsmooth {} {}\n", lead, command.name, form);
    lead = "       ";
  }
  const bool short_page = command.everyday.empty();  // has room for it
  if (complete || short_page) out += '\n' + wrapped(command.description, 0) + '\n';
  out += "\noptions:\n";
  const std::vector<CommandOption> shown = complete ? command.options : everyday_options(command);
  for (const CommandOption& o : shown) {
    out += entry(option_heading(o), option_help(o));
  }
  out += entry("-h, --help", complete ? "the everyday options" : "this page");
  const std::size_t more = command.options.size() - shown.size();
  out += entry("    --help-all", complete   ? "this page"
                                 : more > 0 ? fmt::format("everything: {} more options, exit codes", more)
                                            : std::string("this page and the exit codes"));
  if (!complete) return out;
  out += "\nexit codes:\n";
  for (const ExitCode& e : kExitCodes) out += entry(std::to_string(e.code), e.meaning);
  return out;
}

}  // namespace rfsmooth::cli
