#pragma once
// A hash to tell whether bytes changed (FNV-1a, 64 bits): not for adversaries.

#include <cstdint>
#include <string_view>

namespace smelt {

inline std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t seed = 0xcbf29ce484222325ULL) {
  std::uint64_t hash = seed;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace smelt
