/// rfsmooth completion: completion scripts for bash and zsh, from the commands' own tables. The build runs it
/// and installs the scripts.
#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/commands/command.h"

namespace rfsmooth::cli {

namespace {

std::vector<std::string> words_of(const Command& command) {
  std::vector<std::string> words = {"-h", "--help", "--help-all"};
  for (const CommandOption& o : command.options) {
    if (o.short_name) words.push_back(fmt::format("-{}", o.short_name));
    for (const std::string& name : typed_names(o)) words.push_back(name);
  }
  return words;
}

std::string bash_script(const std::vector<Command>& commands) {
  std::string names, options, values, first;
  for (const Command& c : commands) {
    names += (names.empty() ? "" : " ") + c.name;
    if (!c.first_words.empty())
      first += fmt::format("    {}:2) first=\"{}\" ;;\n", c.name, fmt::join(c.first_words, " "));
    options += fmt::format("    {}) words=\"{}\" ;;\n", c.name, fmt::join(words_of(c), " "));
    for (const CommandOption& o : c.options) {
      if (o.kind == ValueKind::flag || o.kind == ValueKind::file) continue;
      std::string choices = fmt::format("{}", fmt::join(o.choices, " "));
      if (o.optional) choices += choices.empty() ? "auto" : " auto";
      values += fmt::format("    {}:--{}) COMPREPLY=($(compgen -W \"{}\" -- \"$cur\")); return ;;\n", c.name,
                            o.name, choices);
    }
  }
  return fmt::format(R"(# bash completion for rfsmooth; made by: rfsmooth completion bash
_rfsmooth() {{
  local cur="${{COMP_WORDS[COMP_CWORD]}}" prev="${{COMP_WORDS[COMP_CWORD-1]}}" command="${{COMP_WORDS[1]}}" words="" first=""
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{} --help --help-all --version" -- "$cur"))
    return
  fi
  case "$command:$prev" in
{}  esac
  case "$command" in
{}  esac
  case "$command:$COMP_CWORD" in
{}  esac
  case "$cur" in
    -*) COMPREPLY=($(compgen -W "$words" -- "$cur")) ;;
    *) if [ -n "$first" ]; then COMPREPLY=($(compgen -W "$first" -- "$cur")); else COMPREPLY=($(compgen -f -- "$cur")); fi ;;
  esac
}}
complete -o filenames -F _rfsmooth rfsmooth
)",
                     names, values, options, first);
}

/// Text inside _arguments '...[text]'.
std::string zsh_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_option(const CommandOption& o) {
  std::string value;
  if (o.kind == ValueKind::file)
    value = ":file:_files";
  else if (!o.choices.empty())
    value = fmt::format(":{}:({}{})", value_name(o), fmt::join(o.choices, " "), o.optional ? " auto" : "");
  else if (o.kind != ValueKind::flag)
    value = fmt::format(":{}:({})", value_name(o), o.optional ? "auto" : "");
  std::string lines;
  for (const std::string& name : typed_names(o))
    lines += fmt::format("        '{}[{}]{}' \\\n", name, zsh_escaped(o.help), value);
  return lines;
}

std::string zsh_script(const std::vector<Command>& commands) {
  std::string names, cases;
  for (const Command& c : commands) {
    names += fmt::format("    '{}:{}'\n", c.name, zsh_escaped(c.summary));
    cases += fmt::format("    {})\n      _arguments \\\n", c.name);
    for (const CommandOption& o : c.options) cases += zsh_option(o);
    if (!c.first_words.empty())
      cases += fmt::format("        '1:{}:({})' \\\n", c.name, fmt::join(c.first_words, " "));
    cases +=
        "        '--help[everyday options]' '--help-all[everything about the command]' '*:file:_files' ;;\n";
  }
  return fmt::format(R"(#compdef rfsmooth
# zsh completion for rfsmooth; made by: rfsmooth completion zsh
_rfsmooth() {{
  local -a commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_rfsmooth "$@"
)",
                     names, cases);
}

std::string script(const std::vector<std::string>& arguments) {
  const std::string shell = arguments.size() == 1 ? arguments[0] : "";
  if (shell != "bash" && shell != "zsh")
    fail(ErrorCode::usage, "rfsmooth completion takes one argument: bash or zsh");
  return shell == "bash" ? bash_script(all_commands()) : zsh_script(all_commands());
}

}  // namespace

Command completion_command() {
  Command command = text_command(
      "completion", "print a completion script for bash or zsh", "bash|zsh",
      "Prints the script on standard output; source it, or put it where the shell looks for it.", script);
  command.first_words = {"bash", "zsh"};
  return command;
}

}  // namespace rfsmooth::cli
