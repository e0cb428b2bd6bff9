/// Runs the real binary and says what it did: exit code, stdout, stderr.
#pragma once

#include <csignal>
#include <string>
#include <vector>

namespace rfsmooth::test {

struct Ran {
  int code = -1;  ///< exit code; 128 + signal if it was killed
  std::string out, err;
  double seconds = 0, processor_seconds = 0;  ///< their ratio: how many threads were at work
  double seconds_after_interrupt = 0;         ///< from the signal to the end; 0 without one
  std::size_t peak = 0;                       ///< resident bytes, at least those of the test that started it
};

struct RunSetup {
  std::string input;                     ///< given on standard input
  bool hold_input_open = false;          ///< standard input does not end while the program runs
  std::string folder;                    ///< working folder; empty: the test's own
  std::vector<std::string> environment;  ///< "NAME=value", added
  std::size_t address_space = 0;         ///< bytes; 0 = no limit
  int interrupt_after_ms = -1;           ///< sends the signal then; -1 = never
  std::string interrupt_when;            ///< sends the signal when stderr says this
  int interrupt_by = SIGINT;             ///< the signal
  bool terminal = false;                 ///< stderr is a terminal
};

/// `arguments` do not include the program. A run of more than half an hour is killed (code 137).
Ran rfsmooth(const std::vector<std::string>& arguments, const RunSetup& setup = {});

/// The same for any program.
Ran run_program(const std::string& program, const std::vector<std::string>& arguments,
                const RunSetup& setup = {});

}  // namespace rfsmooth::test
