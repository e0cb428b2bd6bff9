/// The exit codes of the command (README, "Exit codes").
#pragma once

#include <optional>
#include <stdexcept>

#include <rfsmooth/result.h>

namespace rfsmooth::cli {

/// A way in which the command ends.
struct ExitCode {
  int code;
  std::optional<ErrorCode> error;  ///< none: the work is done
  const char* name;                ///< of the error, as Python has it
  const char* meaning;             ///< as help says it
};

inline constexpr ExitCode kExitCodes[] = {
    {0, std::nullopt, "done", "done"},
    {1, ErrorCode::internal, "internal",
     "internal error, or (with several inputs) some of them failed for different reasons"},
    {2, ErrorCode::usage, "usage", "wrong usage: an unknown option, a value outside its range"},
    {3, ErrorCode::input_unreadable, "input_unreadable",
     "input cannot be read, or is not what it says it is"},
    {4, ErrorCode::no_usable_points, "no_usable_points", "no usable points in the input"},
    {5, ErrorCode::cannot_write, "cannot_write",
     "output cannot be written, or exists and --force was not given"},
    {6, ErrorCode::out_of_memory, "out_of_memory",
     "not enough memory (estimated before starting, or met on the way)"},
    {127, ErrorCode::not_installed, "not_installed",
     "reconstruct or render needs a program or a library that is not installed"},
    {130, ErrorCode::cancelled, "cancelled",
     "cancelled (Ctrl-C, kill, or the end of the terminal but under nohup); no file is left behind"}};

/// How the command ends with that error.
inline const ExitCode& exit_of(ErrorCode error) {
  for (const ExitCode& exit : kExitCodes)
    if (exit.error == error) return exit;
  throw std::invalid_argument("exit_of: not an ErrorCode");
}

/// Its number.
inline int exit_code(ErrorCode error) {
  return exit_of(error).code;
}

}  // namespace rfsmooth::cli
