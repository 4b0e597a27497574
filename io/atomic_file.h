#pragma once
// A file appears whole or not at all: write beside it, check, then rename.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace smelt {

/// Writes `bytes` to `path` through a temporary file beside it, which no other writer has, on this machine or on
/// another one that shares the folder; those that killed writers of `path` left are taken away. Every write is checked,
/// the file flushed to the disk and then renamed, so that a reader, a crash or a full disk never meets half a file. On
/// failure the temporary is removed, an older file under `path` is left as it was, and an Error names the path, the
/// reason and what to do.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The same for libraries that want a file name: `write` fills the temporary file whose path it is given and throws
/// where it cannot. Its exceptions go to the caller after the temporary is removed.
void write_file_atomically(const std::filesystem::path& path,
                           const std::function<void(const std::filesystem::path& temporary)>& write);

/// While it lives no other process holds a lock of the same folder. Where a file system has no locks it does nothing.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int fd_;
};

/// Makes `folder` and its parents; no-op where it exists. Throws Error where it cannot, or where a file is in the way.
void create_directories_or_fail(const std::filesystem::path& folder);

/// The whole of a file. Throws Error where it is missing, a folder, or cannot be read.
std::string read_file(const std::filesystem::path& path);

}  // namespace smelt
