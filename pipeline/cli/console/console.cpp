#include "pipeline/cli/console/console.h"

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "pipeline/cli/console/stop.h"

namespace rfsmooth::cli {

namespace {
constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr int kBarWidth = 28;
}  // namespace

bool stdout_reader_is_gone() {
  pollfd out = {STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) > 0 && (out.revents & (POLLERR | POLLHUP)) != 0;
}

void to_stderr(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

Console::Console(const ConsoleOptions& options, std::function<void(LogLevel, const std::string&)> listener)
    : listener_(std::move(listener)),
      threads_(options.threads),
      quiet_(options.quiet),
      verbose_(options.verbose && !options.quiet) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const char* type = std::getenv("TERM");
  const bool dumb = type != nullptr && std::string_view(type) == "dumb";
  const char* no_colour = std::getenv("NO_COLOR");  // no-color.org: set and not empty
  bar_ = terminal && !dumb && !quiet_ && !listener_;
  colour_ = terminal && !dumb && (no_colour == nullptr || *no_colour == '\0');
}

Console::~Console() {
  clear_bar();
}

void Console::print(const char* colour, const char* label, const std::string& line) {
  clear_bar();
  const bool coloured = colour_ && *label != '\0';
  to_stderr(coloured ? fmt::format("rfsmooth: {}{}\x1b[0m{}\n", colour, label, line)
                     : fmt::format("rfsmooth: {}{}\n", label, line));
}

void Console::say(const std::string& line) {
  if (listener_) return listener_(LogLevel::info, line);
  if (!quiet_) print("", "", line);
}
void Console::detail(const std::string& line) {
  if (listener_) return listener_(LogLevel::debug, line);
  if (verbose_) print("", "", line);
}
void Console::warn(const std::string& line) {
  if (listener_) return listener_(LogLevel::warning, line);
  if (!quiet_) print("\x1b[33m", "warning: ", line);
}
void Console::error(const std::string& line) {
  if (listener_) return listener_(LogLevel::warning, line);
  print("\x1b[31m", "error: ", line);
}

Context Console::context(std::vector<StageShare> stages) {
  progress_.plan(std::move(stages));
  if (threads_) limit_.emplace(*threads_);
  Context context;
  context.threads = threads_.value_or(0);
  context.stop = &stop_flag();
  context.progress = [this](std::string_view stage, double fraction) {
    draw(stage, fraction);
    return true;  // Ctrl-C arrives through `stop`
  };
  context.log = [this](LogLevel level, const std::string& text) {
    if (level == LogLevel::warning)
      warn(text);
    else
      detail(text);
  };
  return context;
}

void Console::draw(std::string_view stage, double fraction) {
  const bool new_stage = progress_.stage() != stage;
  progress_.note(stage, fraction);
  if (!bar_) return;
  const auto now = std::chrono::steady_clock::now();
  if (!new_stage && progress_.done() < 1 && now - last_draw_ < kRedraw) return;
  last_draw_ = now;
  const int filled = int(progress_.done() * kBarWidth);
  std::string line = fmt::format("{:<12.12} [{}{}] {:3.0f} %", stage, std::string(std::size_t(filled), '#'),
                                 std::string(std::size_t(kBarWidth - filled), '.'), 100 * progress_.done());
  const double elapsed = progress_.stage_seconds();
  if (progress_.in_stage() > 0 && elapsed > 0.2) {
    if (points_ > 0)
      line += fmt::format("  {:.3g} points/s", double(points_) * progress_.in_stage() / elapsed);
    line += fmt::format("  {:.0f} s left", progress_.seconds_left());
  }
  to_stderr("\r\x1b[K" + line);
  drawn_ = true;
}

void Console::clear_bar() {
  if (!drawn_) return;
  to_stderr("\r\x1b[K");
  drawn_ = false;
}

}  // namespace rfsmooth::cli
