#include "io/obj.h"

#include "core/error.h"
#include "io/atomic_file.h"

#include <fmt/compile.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace smelt {
namespace {

/// Text for items 0 .. n-1, formatted in parallel in blocks of fixed size and joined in order.
template <typename FormatItem>
void append_lines(std::string& text, std::size_t n, FormatItem format_item) {
  constexpr std::size_t block_size = 4096;
  std::vector<std::string> blocks((n + block_size - 1) / block_size);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    blocks[b].reserve(block_size * 40);
    for (std::size_t i = b * block_size; i < std::min(n, (b + 1) * block_size); ++i)
      format_item(std::back_inserter(blocks[b]), i);
  });
  for (const std::string& block : blocks) text += block;
}

void check_finite(const std::filesystem::path& path, std::string_view what, std::size_t i, const Vec3f& v) {
  if (!v.allFinite())
    fail("{}: {} {} is ({}, {}, {}) and cannot be written; a surface must be finite, look at its particles",
         path.string(), what, i + 1, v.x(), v.y(), v.z());
}

/// A cursor over the text of an OBJ file that knows its line.
class Scanner {
 public:
  Scanner(const std::filesystem::path& path, std::string_view text) : path_(path), rest_(text) {}

  /// The first word of the next line that is neither empty nor a comment; none at the end of the file. A comment is
  /// handed to `see_comment`.
  template <typename SeeComment>
  std::optional<std::string_view> next_keyword(SeeComment see_comment) {
    while (!rest_.empty()) {
      ++n_line_;
      const std::size_t end = std::min(rest_.find('\n'), rest_.size());
      line_ = rest_.substr(0, end);
      rest_.remove_prefix(std::min(end + 1, rest_.size()));
      if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
      if (line_.starts_with('#')) see_comment(line_);
      const std::string_view word = next_word();
      if (!word.empty() && word[0] != '#') return word;
    }
    return std::nullopt;
  }

  /// The next word of the line; empty at its end.
  std::string_view next_word() {
    const std::size_t begin = std::min(line_.find_first_not_of(" \t"), line_.size());
    const std::size_t end = std::min(line_.find_first_of(" \t", begin), line_.size());
    const std::string_view word = line_.substr(begin, end - begin);
    line_.remove_prefix(end);
    return word;
  }

  float next_float() {
    const std::string_view word = next_word();
    float value = 0.0f;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      reject("a finite number", word);
    return value;
  }

  Vec3f next_vector() {
    const float x = next_float(), y = next_float(), z = next_float();
    if (const std::string_view word = next_word(); !word.empty()) reject("three numbers", word);
    return {x, y, z};
  }

  /// Three numbers, and three more where there is a colour, which is skipped.
  Vec3f next_position() {
    const float x = next_float(), y = next_float(), z = next_float();
    const std::string_view red = next_word(), green = next_word(), blue = next_word();
    if (red.empty() == blue.empty() && red.empty() == green.empty() && next_word().empty()) return {x, y, z};
    reject("three numbers, or six with a colour", red);
  }

  /// "a", "a/b", "a//c" or "a/b/c"; a normal must have the index of its vertex.
  std::uint32_t next_corner(std::size_t n_vertices) {
    const std::string_view word = next_word();
    const std::size_t slash = std::min(word.find('/'), word.size()), last_slash = word.rfind('/');
    const std::uint32_t index = to_index(word.substr(0, slash), word);
    if (last_slash != std::string_view::npos && last_slash > slash &&
        to_index(word.substr(last_slash + 1), word) != index)
      reject("a normal with the index of its vertex (other files can be imported as meshes)", word);
    if (index > n_vertices) reject(fmt::format("a vertex from 1 to {}, given before the face", n_vertices), word);
    return index - 1;
  }

  [[noreturn]] void reject(std::string_view allowed, std::string_view found) const {
    fail("{}:{}: expected {}, found '{}'; the file is damaged or not written by smelt, write it again", path_.string(),
         n_line_, allowed, found);
  }

 private:
  std::uint32_t to_index(std::string_view digits, std::string_view word) const {
    std::uint32_t index = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (error != std::errc() || end != digits.data() + digits.size() || index == 0) reject("an index from 1", word);
    return index;
  }

  const std::filesystem::path& path_;
  std::string_view rest_, line_;
  std::size_t n_line_ = 0;
};

/// What the leading comment promises: "# smelt surface: 8 vertices, 12 triangles".
struct Promise {
  std::size_t n_vertices, n_triangles;
};
constexpr std::string_view promise_start = "# smelt surface: ";

std::optional<Promise> read_promise(std::string_view comment) {
  if (!comment.starts_with(promise_start)) return std::nullopt;
  Promise promise{};
  const char* const end = comment.data() + comment.size();
  const auto vertices = std::from_chars(comment.data() + promise_start.size(), end, promise.n_vertices);
  const std::string_view between = " vertices, ";
  if (!std::string_view(vertices.ptr, end).starts_with(between)) return std::nullopt;
  const auto triangles = std::from_chars(vertices.ptr + between.size(), end, promise.n_triangles);
  return triangles.ec == std::errc() ? std::optional(promise) : std::nullopt;
}

void check_counts(const std::filesystem::path& path, const SurfaceMesh& surface,
                  const std::optional<Promise>& promise) {
  const std::size_t n_vertices = surface.mesh.vertices.size(), n_triangles = surface.mesh.triangles.size();
  if (promise && (promise->n_vertices != n_vertices || promise->n_triangles != n_triangles))
    fail(
        "{}: holds {} vertices and {} triangles where its first line gives {} and {}; the file is truncated, write it "
        "again",
        path.string(), n_vertices, n_triangles, promise->n_vertices, promise->n_triangles);
  if (!promise && n_triangles == 0) fail("{}: has no triangles; is it a surface?", path.string());
  if (!surface.normals.empty() && surface.normals.size() != n_vertices)
    fail("{}: holds {} normals for {} vertices; one for each is needed, write the file again", path.string(),
         surface.normals.size(), n_vertices);
}

}  // namespace

void write_obj(const std::filesystem::path& path, const SurfaceMesh& surface, std::span<const Vec3f> colours) {
  const TriangleMesh& mesh = surface.mesh;
  CHECK_EQ(surface.normals.size(), mesh.vertices.size());
  if (!colours.empty()) CHECK_EQ(colours.size(), mesh.vertices.size());
  std::string text =
      fmt::format("{}{} vertices, {} triangles\n", promise_start, mesh.vertices.size(), mesh.triangles.size());
  text.reserve(80 * mesh.vertices.size() + 50 * mesh.triangles.size());
  append_lines(text, mesh.vertices.size(), [&](auto out, std::size_t i) {
    const Vec3f v = mesh.vertices[i].cast<float>();
    check_finite(path, "vertex", i, v);
    if (colours.empty()) {
      fmt::format_to(out, FMT_COMPILE("v {} {} {}\n"), v.x(), v.y(), v.z());
      return;
    }
    const Vec3f& c = colours[i];
    check_finite(path, "colour", i, c);
    fmt::format_to(out, FMT_COMPILE("v {} {} {} {:.4f} {:.4f} {:.4f}\n"), v.x(), v.y(), v.z(), c.x(), c.y(), c.z());
  });
  append_lines(text, surface.normals.size(), [&](auto out, std::size_t i) {
    const Vec3f& n = surface.normals[i];
    check_finite(path, "normal", i, n);
    fmt::format_to(out, FMT_COMPILE("vn {} {} {}\n"), n.x(), n.y(), n.z());
  });
  append_lines(text, mesh.triangles.size(), [&](auto out, std::size_t i) {
    const auto& t = mesh.triangles[i];
    fmt::format_to(out, FMT_COMPILE("f {}//{} {}//{} {}//{}\n"), t[0] + 1, t[0] + 1, t[1] + 1, t[1] + 1, t[2] + 1,
                   t[2] + 1);
  });
  write_file_atomically(path, text);
}

SurfaceMesh read_obj(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  SurfaceMesh surface;
  std::optional<Promise> promise;
  Scanner scanner(path, text);
  const auto see_comment = [&](std::string_view comment) {
    if (!promise) promise = read_promise(comment);
  };
  while (const auto keyword = scanner.next_keyword(see_comment)) {
    if (*keyword == "v") {
      surface.mesh.vertices.push_back(scanner.next_position().cast<double>());
    } else if (*keyword == "vn") {
      surface.normals.push_back(scanner.next_vector());
    } else if (*keyword == "f") {
      const std::size_t n = surface.mesh.vertices.size();
      const std::uint32_t a = scanner.next_corner(n), b = scanner.next_corner(n), c = scanner.next_corner(n);
      if (const std::string_view word = scanner.next_word(); !word.empty()) scanner.reject("a triangle", word);
      surface.mesh.triangles.push_back({a, b, c});
    } else {
      scanner.reject("v, vn or f", *keyword);
    }
  }
  check_counts(path, surface, promise);
  return surface;
}

bool is_empty_surface(const std::filesystem::path& path) {
  return read_file(path) == fmt::format("{}0 vertices, 0 triangles\n", promise_start);
}

}  // namespace smelt
