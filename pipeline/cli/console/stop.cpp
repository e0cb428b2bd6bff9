#include "pipeline/cli/console/stop.h"

#include <initializer_list>

namespace rfsmooth::cli {

namespace {
std::atomic<bool> stopped{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not lock");

extern "C" void set_stopped(int) {
  stopped.store(true, std::memory_order_relaxed);  // no other data hang on the flag
}
}  // namespace

const std::atomic<bool>& stop_flag() {
  return stopped;
}

struct sigaction handle_unless_ignored(int signal, const struct sigaction& handler) {
  struct sigaction before = {};
  sigaction(signal, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(signal, &handler, nullptr);
  return before;
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = set_stopped;
  sigemptyset(&action.sa_mask);
  action.sa_flags = 0;  // not SA_RESTART: a read that waits for standard input is to return
  for (const int signal : kCancelling) handle_unless_ignored(signal, action);
  // Writing to a closed pipe, or beyond the size that files may have, then fails: exit code 5.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

}  // namespace rfsmooth::cli
