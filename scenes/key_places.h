#pragma once
// Where the keys of a scene stand, so that what is found wrong with a value later can still say where to mend it.

#include "core/error.h"

#include <algorithm>
#include <map>
#include <string>

namespace smelt {

class KeyPlaces {
 public:
  KeyPlaces() = default;
  explicit KeyPlaces(std::string file) : file_(std::move(file)) {}

  const std::string& file() const { return file_; }
  void locate(const std::string& key_path, int line) { lines_[key_path] = line; }
  /// Remembers that a key was set on the command line, as `text`.
  void overridden(const std::string& key_path, const std::string& text) { overrides_[key_path] = text; }

  struct Place {
    int line = 0;      ///< 0 on the command line
    std::string text;  ///< "scene.toml:12: collider.0.mesh"; the key path alone in a scene without a file
  };

  /// `key_path` need not exist: the line is then that of the innermost table around it that does.
  Place find(const std::string& key_path) const {
    // An array's element stands where its array does.
    std::string at = key_path.substr(0, key_path.find('['));
    for (const auto& [path, text] : overrides_)
      if (at == path || at.starts_with(path + ".")) return {0, fmt::format("{}: {}", text, key_path)};
    if (file_.empty()) return {0, key_path};
    while (!lines_.contains(at) && at.find('.') != std::string::npos) at = at.substr(0, at.rfind('.'));
    const int line = std::max(lines_.contains(at) ? lines_.at(at) : 1, 1);
    return {line, fmt::format("{}:{}: {}", file_, line, key_path)};
  }

 private:
  std::string file_;
  std::map<std::string, int> lines_;
  std::map<std::string, std::string> overrides_;
};

/// Runs `body`; an Error that it throws comes out with the place of `key_path` in front.
template <typename Body>
auto blame(const KeyPlaces& places, const std::string& key_path, const Body& body) {
  try {
    return body();
  } catch (const Error& error) {
    fail("{}: {}", places.find(key_path).text, error.what());
  }
}

}  // namespace smelt
