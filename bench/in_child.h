#pragma once
// Runs a measurement in a process of its own, so that its peak memory is its alone.

#include "core/error.h"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <sys/wait.h>
#include <type_traits>
#include <unistd.h>

namespace smelt {

namespace in_child {

/// How the child ended, the first byte that it sends; its result or a message follows.
enum class Outcome : char { result = 'r', error = 'e', no_memory = 'm', diverged = 'd', broken = 'b' };

inline void send(int fd, Outcome outcome, std::string_view rest) {
  std::string bytes(1, static_cast<char>(outcome));
  bytes += rest;
  for (std::string_view left = bytes; !left.empty();) {
    const ssize_t n = ::write(fd, left.data(), left.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) std::_Exit(1);
    left.remove_prefix(static_cast<std::size_t>(n));
  }
}

inline std::string receive(int fd) {
  std::string bytes;
  char part[4096];
  for (;;) {
    const ssize_t n = ::read(fd, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return bytes;
    bytes.append(part, static_cast<std::size_t>(n));
  }
}

/// Measures, and tells what came of it; nothing leaves through the stack that the parent left.
template <typename Measure>
[[noreturn]] void measure_and_exit(const Measure& measure, int fd) {
  try {
    const auto result = measure();
    send(fd, Outcome::result, {reinterpret_cast<const char*>(&result), sizeof result});
  } catch (const DivergedError& error) {
    send(fd, Outcome::diverged, error.what());
  } catch (const Error& error) {
    send(fd, Outcome::error, error.what());
  } catch (const std::bad_alloc&) {
    send(fd, Outcome::no_memory, "");
  } catch (const std::exception& error) {
    send(fd, Outcome::broken, error.what());
  }
  std::_Exit(0);
}

}  // namespace in_child

/// What `measure()` returns in a child process. To be called before this process has any threads. Errors of the child
/// are thrown here: Error, also where it ran out of memory or was killed for want of it, DivergedError; InternalError
/// for all others.
template <typename Measure>
auto run_in_child(const Measure& measure) {
  using in_child::Outcome;
  using Result = decltype(measure());
  static_assert(std::is_trivially_copyable_v<Result>);
  int ends[2];
  if (pipe(ends) != 0) throw InternalError("bench: no pipe");
  std::fflush(nullptr);  // else the child has a copy of what is not printed yet
  const pid_t child = fork();
  if (child < 0) throw InternalError("bench: no child process");
  if (child == 0) in_child::measure_and_exit(measure, ends[1]);
  close(ends[1]);
  const std::string bytes = in_child::receive(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
    fail("bench: the measurement was killed, as the system does where memory runs out; fewer particles would do");
  if (WIFSIGNALED(status)) throw InternalError(fmt::format("bench: signal {} in the child process", WTERMSIG(status)));
  const std::string text = bytes.empty() ? "" : bytes.substr(1);
  switch (bytes.empty() ? Outcome::broken : static_cast<Outcome>(bytes.front())) {
    case Outcome::result:
      if (text.size() == sizeof(Result)) {
        Result result;
        std::memcpy(&result, text.data(), sizeof result);
        return result;
      }
      break;
    case Outcome::error:
      throw Error(text);
    case Outcome::no_memory:
      fail("bench: out of memory; fewer particles would do");
    case Outcome::diverged:
      throw DivergedError(text);
    case Outcome::broken:
      break;
  }
  throw InternalError("bench: the child process failed: " + text);
}

}  // namespace smelt
