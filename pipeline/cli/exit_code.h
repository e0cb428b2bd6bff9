/// The exit codes of the command (README, "Exit codes").
#pragma once

#include <rfsmooth/result.h>

namespace rfsmooth::cli {

inline int exit_code(ErrorCode error) {
  switch (error) {
    case ErrorCode::internal:
      return 1;
    case ErrorCode::usage:
      return 2;
    case ErrorCode::input_unreadable:
      return 3;
    case ErrorCode::no_usable_points:
      return 4;
    case ErrorCode::cannot_write:
      return 5;
    case ErrorCode::out_of_memory:
      return 6;
    case ErrorCode::not_installed:
      return 127;
    case ErrorCode::cancelled:
      return 130;
  }
  return 1;
}

}  // namespace rfsmooth::cli
