#include "tests/bench/support/apart.h"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace rfsmooth::bench {

namespace {

/// What the system says of this process.
double status_of(const char* key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind(key, 0) == 0) return std::stod(line.substr(std::strlen(key)));
  return 0;
}

double resident(const char* key) {
  return 1024 * status_of(key);  // kB
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void measure(const std::function<void()>& work, Cost& cost) {
  malloc_trim(0);                               // memory freed before would be used again unseen
  std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts at what is resident now
  const double before = resident("VmRSS:"), cpu = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  work();
  cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  cost.cpu = cpu_seconds() - cpu;
  cost.bytes = resident("VmHWM:") - before;
}

/// The child's side; returns its exit code.
int run_child(const std::function<std::string(const Measure&)>& job, int to) {
  try {
    Cost cost;
    const std::string said = job([&](const std::function<void()>& work) { measure(work, cost); });
    char line[128];
    std::snprintf(line, sizeof line, "%.9g %.9g %.9g\n", cost.seconds, cost.cpu, cost.bytes);
    const std::string text = line + said;
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t wrote = write(to, text.data() + done, text.size() - done);
      if (wrote <= 0) return 1;
      done += std::size_t(wrote);
    }
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "a run: %s\n", e.what());
    return 1;
  }
}

}  // namespace

Apart run_apart(const std::function<std::string(const Measure&)>& job) {
  // A pool of threads that was started before would look there in the child, and would do nothing.
  if (status_of("Threads:") > 1) throw std::logic_error("run_apart: this process has started threads");
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    _exit(run_child(job, ends[1]));
  }
  close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = read(ends[0], buffer, sizeof buffer)) > 0;) text.append(buffer, std::size_t(got));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (child < 0 || status != 0) throw std::runtime_error("a run failed");
  Apart run;
  const std::size_t line = text.find('\n');
  std::sscanf(text.c_str(), "%lf %lf %lf", &run.cost.seconds, &run.cost.cpu, &run.cost.bytes);
  run.said = text.substr(line + 1);
  return run;
}

}  // namespace rfsmooth::bench
