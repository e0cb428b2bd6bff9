#include "tests/cli/support/run_command.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

namespace rfsmooth::test {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kLimit = std::chrono::minutes(30);  // sanitizers on a machine that does eight other things

struct Pipe {
  int read_end, write_end;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe");
    read_end = ends[0];
    write_end = ends[1];
  }
};

/// A pseudo-terminal that leaves line ends as they are.
Pipe open_terminal() {
  Pipe ends;
  close(ends.read_end);
  close(ends.write_end);
  termios plain{};
  cfmakeraw(&plain);
  if (openpty(&ends.read_end, &ends.write_end, nullptr, &plain, nullptr) != 0)
    throw std::runtime_error("openpty");
  fcntl(ends.read_end, F_SETFD, FD_CLOEXEC);
  fcntl(ends.write_end, F_SETFD, FD_CLOEXEC);
  return ends;
}

void close_and_forget(int& descriptor) {
  if (descriptor >= 0) close(descriptor);
  descriptor = -1;
}

[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments,
                         const RunSetup& setup, const Pipe& in, const Pipe& out, const Pipe& err) {
  dup2(in.read_end, 0);
  dup2(out.write_end, 1);
  dup2(err.write_end, 2);
  for (const int inherited : {SIGPIPE, SIGINT, SIGTERM, SIGHUP}) signal(inherited, SIG_DFL);
  if (!setup.folder.empty() && chdir(setup.folder.c_str()) != 0) _exit(125);
  for (const std::string& variable : setup.environment) putenv(const_cast<char*>(variable.c_str()));
  if (setup.address_space > 0) {
    const rlimit limit{setup.address_space, setup.address_space};
    setrlimit(RLIMIT_AS, &limit);
  }
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());
  _exit(126);
}

}  // namespace

Ran run_program(const std::string& program, const std::vector<std::string>& arguments,
                const RunSetup& setup) {
  Pipe in, out;
  Pipe err = setup.terminal ? open_terminal() : Pipe();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) become(program, arguments, setup, in, out, err);
  close(in.read_end);
  close(out.write_end);
  close(err.write_end);
  fcntl(in.write_end, F_SETFL, O_NONBLOCK);
  signal(SIGPIPE, SIG_IGN);

  Ran ran;
  std::size_t written = 0;
  const auto start = Clock::now();
  std::optional<Clock::time_point> interrupted;
  const auto interrupt_now = [&](Clock::duration elapsed) {
    if (interrupted) return false;
    if (setup.interrupt_after_ms >= 0 && elapsed > std::chrono::milliseconds(setup.interrupt_after_ms))
      return true;
    return !setup.interrupt_when.empty() && ran.err.find(setup.interrupt_when) != std::string::npos;
  };
  while (out.read_end >= 0 || err.read_end >= 0) {
    if (in.write_end >= 0 && written == setup.input.size() && !setup.hold_input_open)
      close_and_forget(in.write_end);
    pollfd watched[3] = {{out.read_end, POLLIN, 0},
                         {err.read_end, POLLIN, 0},
                         {written < setup.input.size() ? in.write_end : -1, POLLOUT, 0}};
    poll(watched, 3, 10);
    for (int k = 0; k < 2; ++k) {
      if ((watched[k].revents & (POLLIN | POLLHUP)) == 0) continue;
      char buffer[65536];
      int& from = k == 0 ? out.read_end : err.read_end;
      const ssize_t got = ::read(from, buffer, sizeof buffer);
      if (got > 0)
        (k == 0 ? ran.out : ran.err).append(buffer, std::size_t(got));
      else if (got == 0 || errno != EINTR)
        close_and_forget(from);
    }
    if (in.write_end >= 0 && (watched[2].revents & (POLLOUT | POLLERR)) != 0) {
      const ssize_t put = write(in.write_end, setup.input.data() + written, setup.input.size() - written);
      if (put > 0)
        written += std::size_t(put);
      else if (errno != EAGAIN && errno != EINTR)
        close_and_forget(in.write_end);
    }
    const auto elapsed = Clock::now() - start;
    if (interrupt_now(elapsed)) {
      kill(child, setup.interrupt_by);
      interrupted = Clock::now();
    }
    if (elapsed > kLimit) kill(child, SIGKILL);
  }
  close_and_forget(in.write_end);
  int status = 0;
  rusage usage = {};
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  ran.processor_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  ran.peak = std::size_t(usage.ru_maxrss) * 1024;
  ran.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (interrupted)
    ran.seconds_after_interrupt = std::chrono::duration<double>(Clock::now() - *interrupted).count();
  ran.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ran;
}

Ran rfsmooth(const std::vector<std::string>& arguments, const RunSetup& setup) {
  return run_program(RFSMOOTH_COMMAND, arguments, setup);
}

}  // namespace rfsmooth::test
