#include "io/vdb_file.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <array>
#include <fstream>
#include <mutex>
#include <string_view>

namespace smelt {
namespace {

void initialise_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

/// Everything is read now, nothing on first use: a damaged file must fail here.
openvdb::GridPtrVec read_all(const std::filesystem::path& path) {
  openvdb::io::File file(path.string());
  file.open(/*delayLoad=*/false);
  const openvdb::GridPtrVecPtr grids = file.getGrids();
  file.close();
  return *grids;
}

/// 128 bits of FNV-1a, as two runs from different starts.
std::array<std::uint64_t, 2> hash_bytes(std::string_view before, std::string_view after) {
  std::array<std::uint64_t, 2> hash = {0xcbf29ce484222325ULL, 0x84222325cbf29ce4ULL};
  for (const std::string_view part : {before, after})
    for (const char c : part)
      for (std::uint64_t& h : hash) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

/// Replaces the random UUID in the header of a .vdb file: 36 characters after the magic number (8 bytes), three version
/// numbers (4 each) and the flag that grid offsets are given (1).
void stamp_uuid(const std::filesystem::path& path) {
  constexpr std::size_t uuid_at = 8 + 3 * 4 + 1, uuid_size = 36;
  std::string bytes = read_file(path);
  CHECK_GT(bytes.size(), uuid_at + uuid_size);
  CHECK_EQ(bytes[uuid_at + 8], '-');
  CHECK_EQ(bytes[uuid_at + 23], '-');
  const auto [high, low] =
      hash_bytes(std::string_view(bytes).substr(0, uuid_at), std::string_view(bytes).substr(uuid_at + uuid_size));
  // Version 8 of RFC 9562: "custom".
  const std::string uuid = fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32, (high >> 16) & 0xffff,
                                       high & 0xfff, 0x8000 | ((low >> 48) & 0x3fff), low & 0xffffffffffff);
  CHECK_EQ(uuid.size(), uuid_size);

  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(uuid_at);
  file.write(uuid.data(), uuid_size);
  file.close();
  if (!file) fail("{}: cannot be rewritten; check the disk or write elsewhere", path.string());
}

}  // namespace

void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids) {
  initialise_openvdb();
  write_file_atomically(path, [&](const std::filesystem::path& temporary) {
    // OpenVDB does not look at its stream after the last write: read_all finds out whether everything arrived.
    try {
      openvdb::io::File file(temporary.string());
      file.write(grids);
      file.close();
      stamp_uuid(temporary);
      CHECK_EQ(read_all(temporary).size(), grids.size());
    } catch (const openvdb::Exception& e) {
      fail("{}: cannot be written: {}; check that the disk is not full, or write elsewhere", path.string(), e.what());
    }
  });
}

openvdb::GridPtrVec read_vdb(const std::filesystem::path& path) {
  initialise_openvdb();
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) fail("{}: there is no such file; check the path", path.string());
  try {
    return read_all(path);
  } catch (const std::exception& e) {
    // Damaged sizes also show as failed allocations.
    fail("{}: is damaged or not an OpenVDB file: {}; write it again", path.string(), e.what());
  }
}

}  // namespace smelt
