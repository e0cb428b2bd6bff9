/// The end of every benchmark's main.
#pragma once

#include <cstdio>
#include <exception>

namespace rfsmooth::bench {

/// The exit code of run(argc, argv); what it throws is told on standard error after the program's name.
inline int tell_failures(const char* name, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", name, e.what());
    return 1;
  }
}

}  // namespace rfsmooth::bench
