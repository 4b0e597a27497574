#include "scenes/scene_writer.h"

#include "core/error.h"
#include "scenes/scene_reader.h"

#include <cmath>

namespace smelt {

namespace {

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + "\"";
}

/// The shortest text that reads back as the same double; TOML wants a point or an exponent in a float.
std::string number_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string vector_text(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", number_text(v[0]), number_text(v[1]), number_text(v[2]));
}

std::string range_text(std::string_view first, std::string_view second, const std::pair<double, double>& value) {
  if (value.first == value.second) return number_text(value.first);
  return fmt::format("{{ {} = {}, {} = {} }}", first, number_text(value.first), second, number_text(value.second));
}

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + number_text(value);
  return "[" + text + "]";
}

std::string thermal_text(const ThermalRange& s) {
  switch (s.law) {
    case ThermalLaw::range:
      return range_text("cold", "hot", {s.cold, s.hot});
    case ThermalLaw::table:
      return fmt::format("{{ temperature_K = {}, values = {} }}", list_text(s.temperature), list_text(s.value));
    case ThermalLaw::exponential:
      return fmt::format("{{ reference = {}, reference_K = {}, rate_1_K = {} }}", number_text(s.reference),
                         number_text(s.reference_temperature), number_text(s.rate));
  }
  throw InternalError("thermal_text: unknown law");
}

/// Writes TOML. The schema visits a table's own keys before its sub-tables, as TOML wants.
class TomlWriter final : public SchemaVisitor {
 public:
  std::string text;

  void number(const Key& key, double& value, const Limits&) override { line(key, number_text(value)); }
  void number(const Key& key, std::optional<double>& value, const Limits&) override {
    if (value) line(key, number_text(*value));
  }
  void required_number(const Key& key, double& value, const Limits&) override { line(key, number_text(value)); }
  void integer(const Key& key, std::int64_t& value, const Limits&) override { line(key, fmt::to_string(value)); }
  void integer(const Key& key, std::optional<std::int64_t>& value, const Limits&) override {
    if (value) line(key, fmt::to_string(*value));
  }
  void required_integer(const Key& key, std::int64_t& value, const Limits&) override {
    line(key, fmt::to_string(value));
  }
  void boolean(const Key& key, bool& value) override { line(key, value ? "true" : "false"); }
  void boolean(const Key& key, std::optional<bool>& value) override {
    if (value) line(key, *value ? "true" : "false");
  }
  void optional_text(const Key& key, std::string& value) override {
    if (!value.empty()) line(key, toml_string(value));
  }
  void required_text(const Key& key, std::string& value) override { line(key, toml_string(value)); }
  void choice(const Key& key, std::string& value, const std::vector<std::string_view>&) override {
    line(key, toml_string(value));
  }
  void choice(const Key& key, std::optional<std::string>& value, const std::vector<std::string_view>&) override {
    if (value) line(key, toml_string(*value));
  }
  void vector(const Key& key, Vec3& value, const Limits&) override { line(key, vector_text(value)); }
  void vector(const Key& key, std::optional<Vec3>& value, const Limits&) override {
    if (value) line(key, vector_text(*value));
  }
  void range(const Key& key, std::string_view first, std::string_view second,
             std::optional<std::pair<double, double>>& value, const Limits&) override {
    if (value) line(key, range_text(first, second, *value));
  }
  void thermal(const Key& key, std::optional<ThermalRange>& value, const Limits&) override {
    if (value) line(key, thermal_text(*value));
  }
  void table(const Key& key, bool* presence, const std::function<void()>& visit_keys) override {
    if (!presence || *presence) open(key, "[", "]", visit_keys);
  }
  void tables(const Key& key, const std::function<std::size_t()>& size, const std::function<void(std::size_t)>&,
              const std::function<void(std::size_t)>& visit_entry) override {
    for (std::size_t k = 0; k < size(); ++k) open(key, "[[", "]]", [&] { visit_entry(k); });
  }

 private:
  void line(const Key& key, const std::string& value) {
    CHECK(!table_closed_);  // TOML would take the line for one of the sub-table's
    pending_heading();
    text += fmt::format("{} = {}\n", key.name, value);
  }

  void open(const Key& key, std::string_view before, std::string_view after, const std::function<void()>& visit) {
    pending_heading();
    const std::string outer = path_;
    path_ = outer.empty() ? std::string(key.name) : fmt::format("{}.{}", outer, key.name);
    heading_ = fmt::format("{}{}{}{}\n", text.empty() ? "" : "\n", before, path_, after);
    table_closed_ = false;
    visit();
    pending_heading();
    path_ = outer;
    table_closed_ = true;
  }

  void pending_heading() {
    text += heading_;
    heading_.clear();
  }

  std::string path_;
  std::string heading_;
  bool table_closed_ = false;  ///< a sub-table of the innermost table has been written
};

/// Writes one markdown table a section.
class ReferenceWriter final : public SchemaVisitor {
 public:
  std::string text;

  void number(const Key& key, double& value, const Limits& limits) override {
    row(key, limits_text(limits), short_number(value));
  }
  void number(const Key& key, std::optional<double>&, const Limits& limits) override {
    row(key, limits_text(limits), "");
  }
  void required_number(const Key& key, double&, const Limits& limits) override {
    row(key, limits_text(limits), "**required**");
  }
  void integer(const Key& key, std::int64_t& value, const Limits& limits) override {
    row(key, "whole, " + limits_text(limits), fmt::to_string(value));
  }
  void integer(const Key& key, std::optional<std::int64_t>&, const Limits& limits) override {
    row(key, "whole, " + limits_text(limits), "");
  }
  void required_integer(const Key& key, std::int64_t&, const Limits& limits) override {
    row(key, "whole, " + limits_text(limits), "**required**");
  }
  void boolean(const Key& key, bool& value) override { row(key, "true or false", value ? "true" : "false"); }
  void boolean(const Key& key, std::optional<bool>&) override { row(key, "true or false", ""); }
  void optional_text(const Key& key, std::string&) override { row(key, "text", ""); }
  void required_text(const Key& key, std::string&) override { row(key, "text", "**required**"); }
  void choice(const Key& key, std::string& value, const std::vector<std::string_view>& choices) override {
    row(key, fmt::format("`{}`", fmt::join(choices, "` `")), toml_string(value));
  }
  void choice(const Key& key, std::optional<std::string>&, const std::vector<std::string_view>& choices) override {
    row(key, fmt::format("`{}`", fmt::join(choices, "` `")), "");
  }
  void vector(const Key& key, Vec3& value, const Limits& limits) override {
    row(key, "three numbers, " + limits_text(limits),
        fmt::format("[{}, {}, {}]", short_number(value[0]), short_number(value[1]), short_number(value[2])));
  }
  void vector(const Key& key, std::optional<Vec3>&, const Limits& limits) override {
    row(key, "three numbers, " + limits_text(limits), "");
  }
  void range(const Key& key, std::string_view first, std::string_view second, std::optional<std::pair<double, double>>&,
             const Limits& limits) override {
    row(key, fmt::format("{}, or `{{ {} = , {} = }}`", limits_text(limits), first, second), "");
  }
  void thermal(const Key& key, std::optional<ThermalRange>&, const Limits& limits) override {
    row(key, limits_text(limits) + ", or by temperature", "");
  }
  void table(const Key& key, bool* presence, const std::function<void()>& visit_keys) override {
    section(key, "[", "]", presence ? " *Optional.*" : "", visit_keys);
  }
  void tables(const Key& key, const std::function<std::size_t()>&, const std::function<void(std::size_t)>& resize,
              const std::function<void(std::size_t)>& visit_entry) override {
    resize(1);
    section(key, "[[", "]]", "", [&] { visit_entry(0); });
  }

 private:
  static std::string short_number(double value) { return fmt::format("{}", value); }

  static std::string limits_text(const Limits& limits) {
    const bool low = std::isfinite(limits.lower), high = std::isfinite(limits.upper);
    const std::string lower = fmt::format("{} {}", limits.open_lower ? ">" : ">=", limits.lower);
    if (low && high) return fmt::format("{} and <= {}", lower, limits.upper);
    return low ? lower : "any";
  }

  void row(const Key& key, const std::string& values, const std::string& fallback) {
    rows_ += fmt::format("| `{}` | {} | {} | {} |\n", key.name, key.meaning, values,
                         fallback.empty() ? std::string(key.without) : fallback);
  }

  void section(const Key& key, std::string_view before, std::string_view after, std::string_view note,
               const std::function<void()>& visit) {
    flush();
    const std::string outer = path_;
    path_ = outer.empty() ? std::string(key.name) : fmt::format("{}.{}", outer, key.name);
    text += fmt::format("\n## `{}{}{}`\n{}.{}\n", before, path_, after, key.meaning, note);
    visit();
    flush();
    path_ = outer;
  }

  void flush() {
    if (!rows_.empty()) text += "\n| key | meaning | values | default |\n|---|---|---|---|\n" + rows_;
    rows_.clear();
  }

  std::string path_;
  std::string rows_;
};

/// A path of a mesh or a panorama that means the same file from any folder.
std::string portable_mesh(const Scene& scene, const std::string& mesh) {
  const std::filesystem::path file = find_mesh(scene, mesh);
  const std::filesystem::path inside = file.lexically_relative(std::filesystem::weakly_canonical(smelt_folder()));
  const bool ours = !inside.empty() && *inside.begin() != "..";
  return ours ? inside.string() : file.string();
}

Scene with_portable_meshes(const Scene& scene) {
  Scene copy = scene;
  for (auto& body : copy.bodies) body.mesh = portable_mesh(scene, body.mesh);
  for (auto& collider : copy.colliders)
    if (collider.mesh != "ground") collider.mesh = portable_mesh(scene, collider.mesh);
  if (!copy.environment.image.empty()) copy.environment.image = portable_mesh(scene, copy.environment.image);
  return copy;
}

}  // namespace

std::string write_scene(const Scene& scene) {
  Scene copy = with_portable_meshes(scene);
  TomlWriter writer;
  visit_scene(writer, copy);
  return writer.text;
}

std::string write_section(const Scene& scene, SceneSection section) {
  Scene copy = with_portable_meshes(scene);
  TomlWriter writer;
  visit_section(writer, copy, section);
  return writer.text;
}

std::string write_scene_reference() {
  ReferenceWriter writer;
  Scene defaults;
  visit_scene(writer, defaults);
  return "# The scene file\n\n"
         "TOML; SI units and kelvin, each key with its unit as a suffix; y is up. Unknown keys are refused. Any key "
         "can be set on the\ncommand line: `--set particles.count=20000 --set body.0.scale=0.2`. This page is printed "
         "by `smelt scene-reference` and checked\nagainst the code by a test.\n" +
         writer.text;
}

}  // namespace smelt
