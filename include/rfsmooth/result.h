/// Data and file failures as values: a Result holds what was asked for, or an Error that says what, where and
/// what to do. Broken preconditions (a caller's bug) are exceptions derived from std instead; there is no
/// third channel. A Result is a value: one thread at a time, or several that only read.
#pragma once

#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

namespace rfsmooth {

/// Why something could not be done.
enum class ErrorCode {
  internal,          ///< a bug of ours
  usage,             ///< an option or argument outside its range
  input_unreadable,  ///< a file that is not what it says it is
  no_usable_points,  ///< no finite point to work on, or no surface in the points
  cannot_write,      ///< the target cannot be created, replaced or completed
  out_of_memory,     ///< not enough memory, estimated before starting or met on the way
  not_installed,     ///< a program or library that the work needs is not there
  cancelled,         ///< the caller asked to stop
};

/// One clear line: what is wrong, where (file, byte or line, point index), and what to do about it.
struct Error {
  ErrorCode code = ErrorCode::internal;
  std::string message;
};

/// A T, or the Error that kept it from being made. Check `ok()` before `value()`.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor): reads as a return
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  /// \throw std::logic_error if this holds an error: asking is the caller's bug.
  T& value() & { return checked(); }
  const T& value() const& { return const_cast<Result*>(this)->checked(); }
  T&& value() && { return std::move(checked()); }

  /// \throw std::logic_error if this holds a value.
  const Error& error() const {
    if (ok()) throw std::logic_error("Result::error() of a success");
    return std::get<1>(state_);
  }

 private:
  T& checked() {
    if (!ok()) throw std::logic_error("Result::value() of a failure: " + std::get<1>(state_).message);
    return std::get<0>(state_);
  }
  std::variant<T, Error> state_;
};

/// What a step without a value returns.
struct Done {};

/// Thrown inside the library to unwind to the front door, which makes it a Result (see `guarded`). It leaves
/// only functions that return no Result, and those say so: Flow::step, and all of mesh.h.
struct Failure : std::runtime_error {
  explicit Failure(Error e) : std::runtime_error(e.message), error(std::move(e)) {}
  Error error;
};

/// Runs `body` (returning T) behind a front door: a Failure becomes its Error, running out of memory becomes
/// ErrorCode::out_of_memory. Exceptions that say "the caller broke a precondition" pass through.
template <class Body>
auto guarded(Body&& body) -> Result<decltype(body())> {
  try {
    return body();
  } catch (const Failure& failure) {
    return failure.error;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::out_of_memory, "not enough memory; use a machine with more, or a smaller cloud"};
  }
}

/// The value of a result inside a front door. \throw Failure with its error if there is none.
template <class T>
T value_or_throw(Result<T> result) {
  if (!result.ok()) throw Failure(result.error());
  return std::move(result).value();
}

}  // namespace rfsmooth
