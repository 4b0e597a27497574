#include "io/vdb_file.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/PointDataGrid.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <string_view>

namespace smelt {
namespace {

/// Reads all grids completely. OpenVDB does not look at its stream, and makes grids of whatever it finds behind the end
/// of a truncated file; hence a stream that throws.
openvdb::GridPtrVec parse(const std::string& bytes) {
  std::istringstream stream(bytes, std::ios::binary);
  stream.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  openvdb::io::Stream file(stream, /*delayLoad=*/false);
  return *file.getGrids();
}

/// Where the UUID lies: behind the magic number (8 bytes), three version numbers (4 each) and the flag that grid
/// offsets are given (1).
constexpr std::size_t uuid_at = 8 + 3 * 4 + 1, uuid_size = 36;

/// Two runs over the bytes before and behind the UUID, eight at a time.
std::array<std::uint64_t, 2> hash_content(std::string_view bytes) {
  std::array<std::uint64_t, 2> hash = {0xcbf29ce484222325ULL, bytes.size()};
  for (std::string_view part : {bytes.substr(0, uuid_at), bytes.substr(uuid_at + uuid_size)})
    while (!part.empty()) {
      std::uint64_t word = 0;
      const std::size_t n = std::min(part.size(), sizeof word);
      std::memcpy(&word, part.data(), n);
      part.remove_prefix(n);
      hash[0] = (hash[0] ^ word) * 0x9e3779b97f4a7c15ULL;
      hash[1] = (hash[1] ^ word) * 0xc2b2ae3d27d4eb4fULL;
      for (std::uint64_t& h : hash) h ^= h >> 29;
    }
  return hash;
}

/// A UUID of version 8 (RFC 9562: "custom"), made from the content of the file.
std::string content_uuid(std::string_view bytes) {
  const auto [high, low] = hash_content(bytes);
  return fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32, (high >> 16) & 0xffff, high & 0xfff,
                     0x8000 | ((low >> 48) & 0x3fff), low & 0xffffffffffff);
}

/// Replaces the random UUID of the file that holds `bytes`.
void stamp_uuid(const std::filesystem::path& path, std::string_view bytes) {
  const std::string_view old = bytes.substr(uuid_at, uuid_size);
  CHECK_EQ(old[8], '-');
  CHECK_EQ(old[23], '-');
  const std::string uuid = content_uuid(bytes);
  CHECK_EQ(uuid.size(), uuid_size);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(uuid_at);
  file.write(uuid.data(), uuid_size);
  file.close();
  if (!file) fail("its header cannot be rewritten");
}

/// The mark of our files: their UUIDs alone do not tell, as other programs put any digits into theirs.
constexpr const char* creator = "smelt";

openvdb::GridCPtrVec with_creator(const openvdb::GridCPtrVec& grids) {
  openvdb::GridCPtrVec marked;
  for (const auto& grid : grids) {
    openvdb::MetaMap metadata(*grid);
    metadata.insertMeta(openvdb::GridBase::META_GRID_CREATOR, openvdb::StringMetadata(creator));
    marked.push_back(grid->copyGridReplacingMetadata(metadata));
  }
  return marked;
}

/// A file that we stamped must still have the content it was stamped for.
void check_uuid(const openvdb::GridPtrVec& grids, std::string_view bytes) {
  const bool is_ours =
      std::any_of(grids.begin(), grids.end(), [](const auto& grid) { return grid->getCreator() == creator; });
  const std::string_view uuid = bytes.substr(uuid_at, uuid_size);
  if (is_ours && uuid[14] == '8' && uuid != content_uuid(bytes)) fail("its content does not fit its UUID");
}

}  // namespace

void initialise_openvdb() {
  static std::once_flag once;
  std::call_once(once, [] { openvdb::initialize(); });
}

void write_vdb(const std::filesystem::path& path, const openvdb::GridCPtrVec& grids) {
  initialise_openvdb();
  write_file_atomically(path, [&](const std::filesystem::path& temporary) {
    try {
      openvdb::io::File file(temporary.string());
      file.write(with_creator(grids));
      file.close();
      const std::string bytes = read_file(temporary);
      CHECK_EQ(parse(bytes).size(), grids.size());
      stamp_uuid(temporary, bytes);
    } catch (const InternalError&) {
      throw;
    } catch (const std::exception& e) {
      fail("{}: cannot be written: {}; check that the disk is not full, or write elsewhere", path.string(), e.what());
    }
  });
}

openvdb::GridPtrVec read_vdb(const std::filesystem::path& path) {
  initialise_openvdb();
  const std::string bytes = read_file(path);
  try {
    openvdb::GridPtrVec grids = parse(bytes);
    check_uuid(grids, bytes);
    return grids;
  } catch (const std::exception& e) {
    // Damaged sizes also show as failed allocations.
    fail("{}: is damaged or not an OpenVDB file: {}; write it again", path.string(), e.what());
  }
}

}  // namespace smelt
