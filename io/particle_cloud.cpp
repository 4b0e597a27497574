#include "io/particle_cloud.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/extension.h"
#include "io/number_rows.h"
#include "io/ply_header.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string_view>

namespace smelt {
namespace {

/// Columns of numbers under names, as all three formats are first read.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::size_t n_rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

// ---------------------------------------------------------------------------------------------------------------- text

std::string_view trimmed(std::string_view word) {
  constexpr std::string_view blank = " \t\"";
  word.remove_prefix(std::min(word.find_first_not_of(blank), word.size()));
  word.remove_suffix(word.size() - std::min(word.find_last_not_of(blank) + 1, word.size()));
  return word;
}

std::vector<std::string_view> split(std::string_view line, bool by_blanks) {
  std::vector<std::string_view> words;
  const std::string_view separators = by_blanks ? " \t" : ",;\t";
  for (;;) {
    const std::size_t end = std::min(line.find_first_of(separators), line.size());
    if (const std::string_view word = trimmed(line.substr(0, end)); !by_blanks || !word.empty()) words.push_back(word);
    if (end == line.size()) return words;
    line.remove_prefix(end + 1);
  }
}

/// Rows of numbers; the first row names the columns where `names` is empty.
Table read_text_table(const std::filesystem::path& path, std::vector<std::string> names, bool by_blanks) {
  const std::string text = read_file(path);
  std::string_view rest = without_byte_order_mark(text);
  Table table;
  table.names = std::move(names);
  table.columns.resize(table.names.size());
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    const std::string_view line = take_line(rest);
    if (trimmed(line).empty() || trimmed(line).front() == '#') continue;
    const std::vector<std::string_view> words = split(line, by_blanks);
    if (table.names.empty()) {
      for (const std::string_view word : words) table.names.push_back(lower_case(word));
      table.columns.resize(words.size());
      continue;
    }
    if (words.size() != table.names.size())
      fail("{}:{}: particle {} has {} numbers; {} are expected ({})", path.string(), line_number, table.n_rows(),
           words.size(), table.names.size(), fmt::join(table.names, ", "));
    const std::size_t row = table.n_rows();
    for (std::size_t c = 0; c < words.size(); ++c) {
      const std::optional<double> value = parse_number(words[c]);
      if (!value)
        fail("{}:{}: expected a number for particle {}, found \"{}\"", path.string(), line_number, row,
             words[c].substr(0, 40));
      table.columns[c].push_back(*value);
    }
  }
  return table;
}

// ----------------------------------------------------------------------------------------------------------------- PLY

template <typename T>
double from_bytes(const char* at, bool swap) {
  std::array<char, sizeof(T)> raw;
  std::copy_n(at, sizeof(T), raw.begin());
  if (swap) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<T>(raw));
}

double read_value(const char* at, std::string_view type, bool swap) {
  const auto is = [&](std::string_view a, std::string_view b) { return type == a || type == b; };
  if (is("float", "float32")) return from_bytes<float>(at, swap);
  if (is("double", "float64")) return from_bytes<double>(at, swap);
  if (is("char", "int8")) return from_bytes<std::int8_t>(at, swap);
  if (is("uchar", "uint8")) return from_bytes<std::uint8_t>(at, swap);
  if (is("short", "int16")) return from_bytes<std::int16_t>(at, swap);
  if (is("ushort", "uint16")) return from_bytes<std::uint16_t>(at, swap);
  if (is("int", "int32")) return from_bytes<std::int32_t>(at, swap);
  return from_bytes<std::uint32_t>(at, swap);
}

[[noreturn]] void fail_on_end(const std::filesystem::path& path, std::size_t particle, std::uint64_t count) {
  fail("{}: ends in particle {} of the {} that its header promises: the file is truncated; write it again",
       path.string(), particle, count);
}

void read_binary_rows(Table& table, const std::filesystem::path& path, std::string_view body, const PlyElement& element,
                      bool swap) {
  std::size_t row_size = 0;
  for (const PlyProperty& p : element.properties) row_size += p.size;
  if (row_size == 0) return;
  if (element.count > body.size() / row_size) fail_on_end(path, body.size() / row_size, element.count);
  for (std::uint64_t row = 0; row < element.count; ++row) {
    const char* at = body.data() + row * row_size;
    for (std::size_t c = 0; c < element.properties.size(); at += element.properties[c].size, ++c)
      table.columns[c].push_back(read_value(at, element.properties[c].type, swap));
  }
}

void read_ascii_rows(Table& table, const std::filesystem::path& path, std::string_view body,
                     const PlyElement& element) {
  for (std::uint64_t row = 0; row < element.count; ++row)
    for (std::size_t c = 0; c < element.properties.size(); ++c) {
      constexpr std::string_view blank = " \t\r\n";
      body.remove_prefix(std::min(body.find_first_not_of(blank), body.size()));
      const std::string_view word = body.substr(0, body.find_first_of(blank));
      if (word.empty()) fail_on_end(path, row, element.count);
      const std::optional<double> value = parse_number(word);
      if (!value) fail("{}: expected a number for particle {}, found \"{}\"", path.string(), row, word.substr(0, 40));
      table.columns[c].push_back(*value);
      body.remove_prefix(word.size());
    }
}

Table read_ply_table(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  const PlyHeader header = read_ply_header(path, text);
  if (header.elements.empty() || header.elements.front().name != "vertex")
    fail("{}: its first element must be `vertex`, the particles", path.string());
  const PlyElement& element = header.elements.front();
  Table table;
  for (const PlyProperty& p : element.properties) {
    if (p.length_size > 0)
      fail("{}: the property `{}` of its vertices is a list; numbers are allowed", path.string(), p.name);
    table.names.push_back(lower_case(p.name));
  }
  table.columns.resize(table.names.size());
  const std::string_view body = std::string_view(text).substr(header.size);
  if (header.encoding == PlyHeader::Encoding::ascii)
    read_ascii_rows(table, path, body, element);
  else
    read_binary_rows(table, path, body, element,
                     (header.encoding == PlyHeader::Encoding::big_endian) != (std::endian::native == std::endian::big));
  return table;
}

// -------------------------------------------------------------------------------------------------------------- fields

/// Takes columns out of a table by any of the names that programs give them.
class Columns {
 public:
  Columns(const std::filesystem::path& path, Table table)
      : path_(path), table_(std::move(table)), used_(table_.names.size()) {}

  const std::vector<double>* find(std::initializer_list<const char*> names) {
    for (const char* name : names)
      for (std::size_t c = 0; c < table_.names.size(); ++c)
        if (table_.names[c] == name) {
          used_[c] = true;
          return &table_.columns[c];
        }
    return nullptr;
  }

  std::vector<float> scalar(const char* name) {
    const std::vector<double>* column = find({name});
    if (!column) return {};
    for (std::size_t i = 0; i < column->size(); ++i)
      if (!std::isfinite((*column)[i]))
        fail("{}: {} of particle {} is {}: it must be finite", path_.string(), name, i, (*column)[i]);
    return std::vector<float>(column->begin(), column->end());
  }

  /// Three columns, or none of them.
  std::vector<Vec3> vector(const char* what, const std::array<std::initializer_list<const char*>, 3>& names) {
    std::array<const std::vector<double>*, 3> c;
    for (int a = 0; a < 3; ++a) c[a] = find(names[a]);
    if (!c[0] && !c[1] && !c[2]) return {};
    for (int a = 0; a < 3; ++a)
      if (!c[a])
        fail("{}: has no column `{}` for the {}; it has {}", path_.string(), *names[a].begin(), what,
             fmt::join(table_.names, ", "));
    std::vector<Vec3> out(table_.n_rows());
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = Vec3((*c[0])[i], (*c[1])[i], (*c[2])[i]);
      if (!out[i].allFinite())
        fail("{}: the {} of particle {} is ({}, {}, {}): it must be finite", path_.string(), what, i, out[i][0],
             out[i][1], out[i][2]);
    }
    return out;
  }

  std::vector<std::string> unused() const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < used_.size(); ++c)
      if (!used_[c]) names.push_back(table_.names[c]);
    return names;
  }
  std::size_t n_rows() const { return table_.n_rows(); }
  const std::vector<std::string>& names() const { return table_.names; }

 private:
  const std::filesystem::path& path_;
  Table table_;
  std::vector<bool> used_;
};

}  // namespace

bool is_particle_cloud(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".ply" || extension == ".xyz" || extension == ".csv";
}

ParticleCloud read_particle_cloud(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  Columns columns(path, extension == ".ply"   ? read_ply_table(path)
                        : extension == ".xyz" ? read_text_table(path, {"x", "y", "z"}, true)
                                              : read_text_table(path, {}, false));
  if (columns.n_rows() == 0) fail("{}: has no particles: there is nothing to make a surface of", path.string());
  ParticleCloud cloud;
  cloud.position = columns.vector("position", {{{"x", "position_x", "points:0", "points_0", "position:0", "p:0"},
                                                {"y", "position_y", "points:1", "points_1", "position:1", "p:1"},
                                                {"z", "position_z", "points:2", "points_2", "position:2", "p:2"}}});
  if (cloud.position.empty())
    fail("{}: has no columns x, y, z; it has {}", path.string(), fmt::join(columns.names(), ", "));
  for (const Vec3& v : columns.vector("velocity", {{{"vx", "v_x", "velocity_x", "v:0", "velocity:0", "velocity_0"},
                                                    {"vy", "v_y", "velocity_y", "v:1", "velocity:1", "velocity_1"},
                                                    {"vz", "v_z", "velocity_z", "v:2", "velocity:2", "velocity_2"}}}))
    cloud.velocity.push_back(v.cast<float>());
  cloud.density = columns.scalar("density");
  for (std::size_t i = 0; i < cloud.density.size(); ++i)
    if (!(cloud.density[i] > 0.0f))
      fail("{}: the density of particle {} is {} kg/m3: it must be positive", path.string(), i, cloud.density[i]);
  cloud.temperature = columns.scalar("temperature");
  cloud.viscosity = columns.scalar("viscosity");
  cloud.unused = columns.unused();
  return cloud;
}

}  // namespace smelt
