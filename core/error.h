#pragma once
// Two ways to fail: `Error` says that the world is wrong (a file, a scene, a disk), `CHECK` that we are.

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace smelt {

/// Bad input or output. The message says where (file:line:key), what was found, what is allowed and what to do.
/// Thrown anywhere, caught in main (exit code 3).
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

/// A file that cannot be written: no other will be either, so nothing goes on after it.
class WriteError : public Error {
 public:
  using Error::Error;
};

/// The simulation went wrong: NaN, an escaped particle, a collapsed time step. The message names the particle, the term
/// and the time (exit code 4).
class DivergedError : public std::runtime_error {
 public:
  explicit DivergedError(const std::string& message) : std::runtime_error(message) {}
};

/// The user asked to stop (exit code 130).
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(const std::string& message) : std::runtime_error(message) {}
};

/// A broken promise inside smelt: our bug (exit code 1).
class InternalError : public std::logic_error {
 public:
  explicit InternalError(const std::string& message) : std::logic_error(message) {}
};

/// Throws an Error from a format string.
template <typename... Args>
[[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) {
  throw Error(fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace smelt

/// Our own invariant: throws InternalError with both values. `CHECK_EQ(a, b)`, `CHECK_LT(a, b)`, ...
#define SMELT_CHECK_OP(a, op, b)                                                                                       \
  do {                                                                                                                 \
    const auto& smelt_check_a = (a);                                                                                   \
    const auto& smelt_check_b = (b);                                                                                   \
    if (!(smelt_check_a op smelt_check_b))                                                                             \
      throw ::smelt::InternalError(fmt::format("{}:{}: CHECK({} {} {}) failed: {} against {}", __FILE__, __LINE__, #a, \
                                               #op, #b, smelt_check_a, smelt_check_b));                                \
  } while (false)
#define CHECK_EQ(a, b) SMELT_CHECK_OP(a, ==, b)
#define CHECK_NE(a, b) SMELT_CHECK_OP(a, !=, b)
#define CHECK_LT(a, b) SMELT_CHECK_OP(a, <, b)
#define CHECK_LE(a, b) SMELT_CHECK_OP(a, <=, b)
#define CHECK_GT(a, b) SMELT_CHECK_OP(a, >, b)
#define CHECK_GE(a, b) SMELT_CHECK_OP(a, >=, b)
#define CHECK(condition) SMELT_CHECK_OP(static_cast<bool>(condition), ==, true)
