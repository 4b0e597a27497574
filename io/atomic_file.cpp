#include "io/atomic_file.h"

#include "core/error.h"
#include "core/hash.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <mutex>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace smelt {
namespace {

/// What a user can do about an errno.
std::string_view advice(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some disk space or write elsewhere";
    case EFBIG:
      return "the file system or a limit (ulimit -f) forbids files of this size; write elsewhere";
    case EACCES:
    case EPERM:
      return "check the permissions of the folder or write elsewhere";
    case EROFS:
      return "the file system is read-only; write elsewhere";
    case ENOENT:
      return "check that the folder exists";
    case ENOTDIR:
      return "a part of the path is a file, not a folder; choose another path";
    case EISDIR:
      return "the path is a folder; choose another name";
    case EIO:
      return "the disk reports a fault; write elsewhere";
    default:
      return "write elsewhere";
  }
}

[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error) {
  throw WriteError(fmt::format("{}: cannot be written: {}; {}", path.string(), std::strerror(error), advice(error)));
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  /// Closing can report an error of an earlier write (NFS, quotas).
  int close() { return ::close(std::exchange(fd_, -1)); }

 private:
  int fd_;
};

void flush_to_disk(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  Descriptor file(temporary, O_RDONLY);
  if (!file.is_open() || ::fsync(file.get()) != 0 || file.close() != 0) fail_to_write(path, errno);
}

void write_all(const std::filesystem::path& temporary, const std::filesystem::path& path, std::string_view bytes) {
  Descriptor file(temporary, O_WRONLY | O_TRUNC);
  if (!file.is_open()) fail_to_write(path, errno);
  while (!bytes.empty()) {
    const ssize_t n = ::write(file.get(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail_to_write(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  if (file.close() != 0) fail_to_write(path, errno);
}

/// Of this machine, and of the process numbers that are seen from here: containers have their own.
std::string machine_mark() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  std::error_code ignored;
  const auto processes = std::filesystem::read_symlink("/proc/self/ns/pid", ignored);
  return fmt::format("{:08x}", hash_bytes(processes.string(), hash_bytes(name.data())) & 0xffffffff);
}

/// Makes an empty file beside `path` that no other writer has, here or on another machine that shares the folder.
std::filesystem::path make_temporary(const std::filesystem::path& path) {
  for (std::random_device random;;) {
    std::filesystem::path temporary = path;  // path.MACHINE-PROCESS-RANDOM.tmp
    temporary += fmt::format(".{}-{}-{:08x}.tmp", machine_mark(), ::getpid(), random());
    Descriptor file(temporary, O_WRONLY | O_CREAT | O_EXCL);
    if (file.is_open()) return temporary;
    if (errno != EEXIST) fail_to_write(path, errno);
  }
}

/// Whether the writer of a temporary file is gone for certain: its process on this machine ended, or nothing was
/// written for a day.
bool is_abandoned(const std::filesystem::path& temporary, const std::string& machine, pid_t process) {
  struct stat status {};
  if (::stat(temporary.c_str(), &status) != 0) return false;
  constexpr std::time_t day = 24 * 3600;
  if (std::time(nullptr) - status.st_mtime > day) return true;
  return machine == machine_mark() && ::kill(process, 0) != 0 && errno == ESRCH;
}

/// Takes away what killed writers left in a folder, once in a process: a shot has thousands of files. What cannot be
/// taken away does no harm.
void sweep_temporaries(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::filesystem::path> swept;
  {
    const std::lock_guard lock(mutex);
    if (!swept.insert(std::filesystem::absolute(folder).lexically_normal()).second) return;
  }
  static const std::regex mark(R"(.*\.([0-9a-f]{8})-([0-9]{1,9})-[0-9a-f]{8}\.tmp)");
  std::error_code ignored;
  for (std::filesystem::directory_iterator entry(folder, ignored), last; !ignored && entry != last;
       entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (std::smatch parts;
        std::regex_match(name, parts, mark) && is_abandoned(entry->path(), parts[1], std::stoi(parts[2])))
      ::unlink(entry->path().c_str());
  }
}

}  // namespace

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  write_file_atomically(path, [&](const std::filesystem::path& temporary) { write_all(temporary, path, bytes); });
}

void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& temporary)>& write) {
  // Made here first: libraries seldom say why a file could not be.
  const std::filesystem::path temporary = make_temporary(path);
  try {
    sweep_temporaries(path.has_parent_path() ? path.parent_path() : ".");
    write(temporary);
    flush_to_disk(temporary, path);
    if (::rename(temporary.c_str(), path.c_str()) != 0) fail_to_write(path, errno);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : fd_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  while (fd_ >= 0 && ::flock(fd_, LOCK_EX) != 0 && errno == EINTR) {
  }
}

FolderLock::~FolderLock() {
  if (fd_ >= 0) ::close(fd_);  // which unlocks
}

void create_directories_or_fail(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) fail("{}: the folder cannot be made: {}; {}", folder.string(), error.message(), advice(error.value()));
  // create_directories keeps silent where a file has the folder's name.
  if (!std::filesystem::is_directory(folder, error))
    fail("{}: the folder cannot be made: a file of that name is in the way; move it or choose another folder",
         folder.string());
}

std::string read_file(const std::filesystem::path& path) {
  Descriptor file(path, O_RDONLY);
  struct stat status {};
  const bool known = file.is_open() && ::fstat(file.get(), &status) == 0;
  if (!known) fail("{}: cannot be read: {}; check the path and its permissions", path.string(), std::strerror(errno));
  if (S_ISDIR(status.st_mode)) fail("{}: cannot be read: it is a folder; name a file", path.string());
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  std::size_t n_read = 0;
  while (true) {
    // The size is only a hint: a pipe has none, and a file may grow.
    if (n_read == bytes.size()) bytes.resize(bytes.size() + 65536);
    const ssize_t n = ::read(file.get(), bytes.data() + n_read, bytes.size() - n_read);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail("{}: cannot be read: {}", path.string(), std::strerror(errno));
    if (n == 0) break;
    n_read += static_cast<std::size_t>(n);
  }
  bytes.resize(n_read);
  return bytes;
}

}  // namespace smelt
