#include "io/vdb_file.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/vdb_summary.h"
#include "tests/io/disk_limit.h"
#include "tests/meshes.h"

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

namespace smelt {
namespace {

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(testing::TempDir()) / ("vdb_file_" + std::to_string(::getpid()) + "_" + name);
}

openvdb::FloatGrid::Ptr make_grid(float value) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(0.0f);
  for (int i = 0; i < 20000; ++i)
    grid->tree().setValue(openvdb::Coord(i % 27, i % 31, i % 37), value + static_cast<float>(i));
  grid->setName("density");
  return grid;
}

TEST(VdbFile, EqualContentGivesEqualBytes) {
  write_vdb(temporary("one.vdb"), {make_grid(1.0f)});
  write_vdb(temporary("two.vdb"), {make_grid(1.0f)});
  write_vdb(temporary("other.vdb"), {make_grid(2.0f)});
  const std::string one = read_file(temporary("one.vdb")), other = read_file(temporary("other.vdb"));
  EXPECT_EQ(one, read_file(temporary("two.vdb")));
  EXPECT_NE(one.substr(21, 36), other.substr(21, 36)) << "the UUID tells contents apart";
}

// OpenVDB puts random digits into its UUIDs, an 8 where ours have their version among them.
TEST(VdbFile, ReadsFilesOfOtherPrograms) {
  openvdb::io::File file(temporary("foreign.vdb").string());
  file.write(openvdb::GridCPtrVec{make_grid(1.0f)});
  file.close();
  std::string bytes = read_file(temporary("foreign.vdb"));
  bytes[21 + 14] = '8';
  write_file_atomically(temporary("foreign.vdb"), bytes);
  EXPECT_EQ(read_vdb(temporary("foreign.vdb")).size(), 1u);
  EXPECT_FALSE(summarise_vdb(temporary("foreign.vdb")).at(0).is_of_smelt);
  write_vdb(temporary("own.vdb"), {make_grid(1.0f)});
  EXPECT_TRUE(summarise_vdb(temporary("own.vdb")).at(0).is_of_smelt);
}

TEST(VdbFile, OpensInOpenVdb) {
  write_vdb(temporary("open.vdb"), {make_grid(1.0f)});
  openvdb::io::File file(temporary("open.vdb").string());
  ASSERT_TRUE(file.open());
  EXPECT_EQ(file.getUniqueTag(), read_file(temporary("open.vdb")).substr(21, 36));
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("density"));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->activeVoxelCount(), make_grid(1.0f)->activeVoxelCount());
  EXPECT_EQ(read_vdb(temporary("open.vdb")).size(), 1u);
}

TEST(VdbFile, ReportsAFullDiskWhateverPartDoesNotFit) {
  const auto grid = make_grid(1.0f);
  write_vdb(temporary("full.vdb"), {grid});
  const std::string whole = read_file(temporary("full.vdb"));
  for (const double part : {0.0, 0.1, 0.5, 0.9, 0.99}) {
    std::string message;
    {
      const DiskLimit limit(static_cast<rlim_t>(part * static_cast<double>(whole.size())));
      message = message_of<Error>([&] { write_vdb(temporary("full.vdb"), {grid}); });
    }
    EXPECT_EQ(message.find(temporary("full.vdb").string() + ": cannot be written"), 0u) << message;
    EXPECT_EQ(read_file(temporary("full.vdb")), whole);
    for (const auto& entry : std::filesystem::directory_iterator(testing::TempDir()))
      EXPECT_FALSE(entry.path().string().starts_with(temporary("full.vdb").string() + ".")) << entry.path();
  }
}

TEST(VdbFile, RefusesFilesThatAreNotWhole) {
  write_vdb(temporary("whole.vdb"), {make_grid(1.0f)});
  const std::string whole = read_file(temporary("whole.vdb"));
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{40}, whole.size() / 2, whole.size() - 3}) {
    write_file_atomically(temporary("cut.vdb"), std::string_view(whole).substr(0, size));
    const std::string message = message_of<Error>([&] { read_vdb(temporary("cut.vdb")); });
    EXPECT_EQ(message.find(temporary("cut.vdb").string() + ": is damaged or not an OpenVDB file"), 0u)
        << size << ": " << message;
  }
  std::string changed = whole;
  changed[whole.size() / 2] = static_cast<char>(changed[whole.size() / 2] ^ 1);
  write_file_atomically(temporary("changed.vdb"), changed);
  EXPECT_THROW(read_vdb(temporary("changed.vdb")), Error);
  EXPECT_NE(message_of<Error>([&] { read_vdb(temporary("missing.vdb")); }).find("No such file"), std::string::npos);
  write_file_atomically(temporary("text.vdb"), "This is not an OpenVDB file, whatever its name says.\n");
  EXPECT_THROW(read_vdb(temporary("text.vdb")), Error);
}

}  // namespace
}  // namespace smelt
