#include "io/atomic_file.h"

#include "core/error.h"
#include "tests/io/disk_limit.h"
#include "tests/meshes.h"

#include <sys/stat.h>
#include <unistd.h>

namespace smelt {
namespace {

namespace fs = std::filesystem;

/// A fresh folder.
fs::path make_folder(const std::string& name) {
  const fs::path folder = fs::path(testing::TempDir()) / ("smelt_atomic_" + name);
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

TEST(AtomicFile, ReportsAFolderWithoutPermission) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const fs::path folder = make_folder("permission");
  ::chmod(folder.c_str(), 0555);
  const std::string message = message_of<Error>([&] { write_file_atomically(folder / "file", "x"); });
  ::chmod(folder.c_str(), 0755);
  EXPECT_NE(message.find("Permission denied; check the permissions"), std::string::npos) << message;
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
