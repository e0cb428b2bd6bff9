#include "pipeline/cli/no_command.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/fail.h"
#include "pipeline/cli/options/suggest.h"
#include "pipeline/io/io.h"

namespace rfsmooth::cli {

namespace {

/// Words that other programs have for what a sub-command does.
struct OtherWord {
  const char *word, *command;
};
constexpr OtherWord kOtherWords[] = {{"smooth", "denoise"},      {"clean", "denoise"}, {"filter", "denoise"},
                                     {"stats", "info"},          {"diff", "compare"},  {"view", "render"},
                                     {"surface", "reconstruct"}, {"show", "render"},   {"plot", "render"},
                                     {"distance", "compare"}};

bool names_a_file(const std::string& word) {
  std::error_code unknown;
  return word == "-" || pipeline::io::format_of_extension(word) ||
         std::filesystem::is_regular_file(word, unknown);
}

bool has_option(const Command& command, const std::string& typed) {
  const std::string name = typed.substr(0, typed.find('='));
  return std::any_of(command.options.begin(), command.options.end(), [&](const CommandOption& o) {
    return name == "--" + o.name || name == "--no-" + o.name ||
           (o.short_name && name == std::string("-") + o.short_name);
  });
}

std::string asked(const std::string& command, std::vector<std::string>::const_iterator first,
                  std::vector<std::string>::const_iterator last) {
  return fmt::format("; did you mean 'rfsmooth {}{}{}'?", command, first == last ? "" : " ",
                     fmt::join(first, last, " "));
}

}  // namespace

void refuse_words_without_command(const std::vector<std::string>& words,
                                  const std::vector<Command>& commands) {
  const std::string& word = words.front();
  const bool option = word.size() > 1 && word[0] == '-';
  std::vector<std::string> names = {"--help", "--help-all", "--version"};
  if (!option) {
    names.clear();
    for (const Command& c : commands) names.push_back(c.name);
  }
  std::string hint;
  const auto other = std::find_if(std::begin(kOtherWords), std::end(kOtherWords),
                                  [&](const OtherWord& w) { return w.word == word; });
  const Command* denoise = find_command(commands, "denoise");
  if (const std::string like = did_you_mean(word, names); !like.empty())
    hint = like;
  else if (option ? denoise != nullptr && has_option(*denoise, word) : names_a_file(word))
    hint = asked("denoise", words.begin(), words.end());
  else if (other != std::end(kOtherWords) && find_command(commands, other->command) != nullptr)
    hint = asked(other->command, words.begin() + 1, words.end());
  else if (words.size() > 1 && std::any_of(words.begin() + 1, words.end(), names_a_file))
    hint = asked("denoise", words.begin() + 1, words.end());
  if (option) fail(ErrorCode::usage, "unknown option {}{}", word.substr(0, word.find('=')), hint);
  fail(ErrorCode::usage, "unknown command '{}'{}", word, hint);
}

}  // namespace rfsmooth::cli
