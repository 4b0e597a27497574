#include "io/checkpoint.h"

#include "core/error.h"
#include "core/hash.h"
#include "io/atomic_file.h"

#include <cstring>
#include <string>
#include <type_traits>

namespace smelt {

namespace {

constexpr std::string_view magic = "smelt checkpoint 3\n";

class ByteWriter {
 public:
  std::string bytes;

  template <typename T>
  void value(const T& v) {
    bytes.append(reinterpret_cast<const char*>(&v), sizeof(T));
  }
  template <typename T>
  void array(const std::vector<T>& values) {
    value(static_cast<std::uint64_t>(values.size()));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
};

class ByteReader {
 public:
  ByteReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  template <typename T>
  void value(T& v) {
    std::memcpy(&v, take(sizeof(T)), sizeof(T));
  }
  template <typename T>
  void array(std::vector<T>& values) {
    std::uint64_t n = 0;
    value(n);
    if (n > bytes_.size() / sizeof(T))
      fail("{}: damaged checkpoint: an array of {} entries does not fit in it", path_, n);
    values.resize(n);
    if (n != 0) std::memcpy(static_cast<void*>(values.data()), take(n * sizeof(T)), n * sizeof(T));
  }

 private:
  const char* take(std::size_t n) {
    if (n > bytes_.size()) fail("{}: damaged checkpoint: it ends too soon", path_);
    const char* at = bytes_.data();
    bytes_.remove_prefix(n);
    return at;
  }

  std::string_view bytes_;
  const std::string& path_;
};

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  ByteWriter writer;
  writer.bytes = magic;
  writer.value(checkpoint.frame);
  writer.value(checkpoint.time);
  writer.value(checkpoint.scene_hash);
  for_each_array(checkpoint.particles, [&](const auto& values) { writer.array(values); });
  writer.value(checkpoint.account.next_id);
  for (const auto* counts : {&checkpoint.account.initial, &checkpoint.account.removed, &checkpoint.account.entered})
    writer.array(*counts);
  writer.array(checkpoint.bodies);
  writer.value(hash_bytes(writer.bytes));
  write_file_atomically(path, writer.bytes);
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const std::string name = path.string();
  if (!std::string_view(bytes).starts_with(magic)) fail("{}: not a checkpoint of this version of smelt", name);
  if (bytes.size() < magic.size() + sizeof(std::uint64_t)) fail("{}: damaged checkpoint: it ends too soon", name);
  const std::string_view content(bytes.data(), bytes.size() - sizeof(std::uint64_t));
  std::uint64_t hash = 0;
  std::memcpy(&hash, bytes.data() + content.size(), sizeof(hash));
  if (hash != hash_bytes(content)) fail("{}: damaged checkpoint: its content does not match its hash", name);

  Checkpoint checkpoint;
  ByteReader reader(content.substr(magic.size()), name);
  reader.value(checkpoint.frame);
  reader.value(checkpoint.time);
  reader.value(checkpoint.scene_hash);
  for_each_array(checkpoint.particles, [&](auto& values) { reader.array(values); });
  reader.value(checkpoint.account.next_id);
  for (auto* counts : {&checkpoint.account.initial, &checkpoint.account.removed, &checkpoint.account.entered})
    reader.array(*counts);
  reader.array(checkpoint.bodies);
  return checkpoint;
}

}  // namespace smelt
