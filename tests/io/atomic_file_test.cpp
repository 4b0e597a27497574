#include "io/atomic_file.h"

#include "core/error.h"
#include "tests/io/disk_limit.h"
#include "tests/meshes.h"

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace smelt {
namespace {

namespace fs = std::filesystem;

/// A fresh folder.
fs::path make_folder(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("smelt_atomic_" + std::to_string(::getpid()) + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

std::size_t count_files(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, WritesAndReplaces) {
  const fs::path folder = make_folder("replace");
  const std::string bytes("a\0b\n", 4);
  write_file_atomically(folder / "file", "the first version, which is longer");
  write_file_atomically(folder / "file", bytes);
  EXPECT_EQ(read_file(folder / "file"), bytes);
  EXPECT_EQ(count_files(folder), 1u);
}

TEST(AtomicFile, LeavesTheOldFileWhereTheWriterThrows) {
  const fs::path folder = make_folder("throw");
  write_file_atomically(folder / "file", "old");
  EXPECT_THROW(write_file_atomically(folder / "file",
                                     [](const fs::path& temporary) {
                                       EXPECT_TRUE(fs::exists(temporary));
                                       throw std::runtime_error("half way");
                                     }),
               std::runtime_error);
  EXPECT_EQ(read_file(folder / "file"), "old");
  EXPECT_EQ(count_files(folder), 1u);
}

// A killed writer cannot take its temporary file away; the next one does, unless somebody may still write to it.
TEST(AtomicFile, SweepsWhatKilledWritersLeft) {
  const fs::path folder = make_folder("killed");
  const pid_t child = ::fork();
  if (child == 0) {
    write_file_atomically(folder / "file", [](const fs::path&) { ::kill(::getpid(), SIGKILL); });
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_EQ(count_files(folder), 1u);
  const fs::path left = fs::directory_iterator(folder)->path();
  // Of another machine: that process cannot be asked. A day later it is taken for dead.
  const std::string mark = left.filename().string().substr(5, 8);
  const fs::path elsewhere = folder / ("file." + std::string(mark == "00000000" ? "11111111" : "00000000") +
                                       left.filename().string().substr(13));
  const fs::path old = folder / "file.22222222-1-33333333.tmp", other = folder / "file.of-mine-too.tmp.txt";
  for (const fs::path& path : {elsewhere, old, other}) std::ofstream(path) << "half";
  fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(25));
  write_file_atomically(folder / "file", [&](const fs::path&) {
    // A second writer of the same file meanwhile.
    write_file_atomically(folder / "file", "second");
  });
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(old));
  EXPECT_TRUE(fs::exists(elsewhere));
  EXPECT_TRUE(fs::exists(other));
  EXPECT_TRUE(fs::exists(folder / "file"));
  EXPECT_EQ(count_files(folder), 3u);
}

TEST(AtomicFile, ReportsAFullDisk) {
  const fs::path folder = make_folder("full");
  write_file_atomically(folder / "file", "old");
  const std::string large(1 << 20, 'x');
  std::string message;
  {
    const DiskLimit limit(1 << 16);
    message = message_of<Error>([&] { write_file_atomically(folder / "file", large); });
  }
  EXPECT_NE(message.find((folder / "file").string() + ": cannot be written: File too large"), std::string::npos)
      << message;
  EXPECT_EQ(read_file(folder / "file"), "old");
  EXPECT_EQ(count_files(folder), 1u);
}

TEST(AtomicFile, NamesThePathAndWhatToDo) {
  const fs::path folder = make_folder("where");
  std::string message = message_of<Error>([&] { write_file_atomically(folder / "none" / "file", "x"); });
  EXPECT_NE(message.find("No such file or directory; check that the folder exists"), std::string::npos) << message;
  write_file_atomically(folder / "file", "x");
  message = message_of<Error>([&] { write_file_atomically(folder / "file" / "below", "x"); });
  EXPECT_NE(message.find("Not a directory; a part of the path is a file"), std::string::npos) << message;
  fs::create_directory(folder / "folder");
  message = message_of<Error>([&] { write_file_atomically(folder / "folder", "x"); });
  EXPECT_NE(message.find("Is a directory"), std::string::npos) << message;
  EXPECT_EQ(count_files(folder), 2u);
}

/// The message of the Error that `act` throws as a user without privileges; empty where it throws none. Only root has
/// to change for that, and no thread may change alone: `act` runs in a child process and must not touch other threads
/// or the test itself.
template <typename Act>
std::string message_without_privileges(Act act) {
  constexpr unsigned nobody = 65534;
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    // _exit: neither the test's own clean-up nor a leak check belongs to the child.
    if (::geteuid() == 0 && (::setgroups(0, nullptr) != 0 || ::setgid(nobody) != 0 || ::setuid(nobody) != 0))
      ::_exit(2);
    try {
      act();
    } catch (const Error& e) {
      const std::string_view message = e.what();
      ::_exit(::write(ends[1], message.data(), message.size()) == static_cast<ssize_t>(message.size()) ? 0 : 3);
    } catch (...) {
      ::_exit(4);
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  std::string message;
  std::array<char, 4096> part;
  for (ssize_t n = 0; (n = ::read(ends[0], part.data(), part.size())) > 0;)
    message.append(part.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = -1;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
      << "status " << status << ": exit 2 no change of user, 3 a broken pipe, 4 another exception";
  return message;
}

TEST(AtomicFile, ReportsAFolderWithoutPermission) {
  const fs::path folder = make_folder("permission");
  for (const char* name : {"open", "shut"}) fs::create_directory(folder / name);
  write_file_atomically(folder / "shut" / "file", "old");
  ::chmod(folder.c_str(), 0755);
  ::chmod((folder / "open").c_str(), 0777);
  ::chmod((folder / "shut").c_str(), 0555);
  // Whatever else could be in the way is in the way of this one too.
  EXPECT_EQ(message_without_privileges([&] { write_file_atomically(folder / "open" / "file", "new"); }), "");
  const fs::path shut = folder / "shut" / "file";
  EXPECT_EQ(
      message_without_privileges([&] { write_file_atomically(shut, "new"); }),
      shut.string() + ": cannot be written: Permission denied; check the permissions of the folder or write elsewhere");
  ::chmod((folder / "shut").c_str(), 0755);
  EXPECT_EQ(read_file(folder / "open" / "file"), "new");
  EXPECT_EQ(read_file(shut), "old");
  EXPECT_EQ(count_files(folder / "shut"), 1u);
}

TEST(AtomicFile, MakesFolders) {
  const fs::path folder = make_folder("make");
  create_directories_or_fail(folder / "a" / "b");
  create_directories_or_fail(folder / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder / "a" / "b"));
  write_file_atomically(folder / "file", "x");
  for (const fs::path& path : {folder / "file", folder / "file" / "below"}) {
    const std::string message = message_of<Error>([&] { create_directories_or_fail(path); });
    EXPECT_EQ(message.find(path.string() + ": the folder cannot be made"), 0u) << message;
  }
}

TEST(AtomicFile, ReadingNamesWhatIsMissing) {
  const fs::path folder = make_folder("read");
  EXPECT_NE(message_of<Error>([&] { read_file(folder / "none"); }).find("No such file"), std::string::npos);
  EXPECT_NE(message_of<Error>([&] { read_file(folder); }).find("it is a folder"), std::string::npos);
}

}  // namespace
}  // namespace smelt
