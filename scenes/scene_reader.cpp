#include "scenes/scene_reader.h"

#include "core/error.h"
#include "io/toml.h"
#include "scenes/nearest_word.h"
#include "scenes/quality.h"
#include "scenes/schema.h"
#include "scenes/validate_scene.h"

#include <cmath>
#include <cstdlib>
#include <set>

namespace smelt {

namespace {

int line_of(const toml::source_region& source) {
  return static_cast<int>(source.begin.line);
}

std::string describe(const Limits& limits, bool whole) {
  const bool low = std::isfinite(limits.lower), high = std::isfinite(limits.upper);
  const std::string kind = whole ? "a whole number" : "a number";
  if (low && high)
    return fmt::format("{} {} {} and up to {}", kind, limits.open_lower ? "above" : "from", limits.lower, limits.upper);
  if (low) return fmt::format("{} {} {}", kind, limits.open_lower ? "above" : "of at least", limits.lower);
  return kind;
}

bool allowed(double value, const Limits& limits) {
  return std::isfinite(value) && (limits.open_lower ? value > limits.lower : value >= limits.lower) &&
         value <= limits.upper;
}

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

/// Fills a scene from a TOML tree, collecting errors as it goes.
class SceneReader final : public SchemaVisitor {
 public:
  SceneReader(const toml::table& root, SceneErrors& errors) : errors_(errors) { scopes_.push_back({&root, "", {}}); }

  void number(const Key& key, double& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_number(*node, path_of(key), value, limits);
  }
  void number(const Key& key, std::optional<double>& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_number(*node, path_of(key), value.emplace(), limits);
  }
  void required_number(const Key& key, double& value, const Limits& limits) override {
    if (const auto* node = require(key)) read_number(*node, path_of(key), value, limits);
  }
  void integer(const Key& key, std::int64_t& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_integer(*node, path_of(key), value, limits);
  }
  void integer(const Key& key, std::optional<std::int64_t>& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_integer(*node, path_of(key), value.emplace(), limits);
  }
  void required_integer(const Key& key, std::int64_t& value, const Limits& limits) override {
    if (const auto* node = require(key)) read_integer(*node, path_of(key), value, limits);
  }
  void boolean(const Key& key, bool& value) override {
    if (const auto* node = find(key)) read_boolean(*node, path_of(key), value);
  }
  void boolean(const Key& key, std::optional<bool>& value) override {
    if (const auto* node = find(key)) read_boolean(*node, path_of(key), value.emplace());
  }
  void optional_text(const Key& key, std::string& value) override {
    if (const auto* node = find(key)) read_text(*node, path_of(key), value);
  }
  void required_text(const Key& key, std::string& value) override {
    if (const auto* node = require(key)) read_text(*node, path_of(key), value);
  }
  void choice(const Key& key, std::string& value, const std::vector<std::string_view>& choices) override {
    if (const auto* node = find(key)) read_choice(*node, path_of(key), value, choices);
  }
  void choice(const Key& key, std::optional<std::string>& value,
              const std::vector<std::string_view>& choices) override {
    if (const auto* node = find(key)) read_choice(*node, path_of(key), value.emplace(), choices);
  }
  void vector(const Key& key, Vec3& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_vector(*node, path_of(key), value, limits);
  }
  void vector(const Key& key, std::optional<Vec3>& value, const Limits& limits) override {
    if (const auto* node = find(key)) read_vector(*node, path_of(key), value.emplace(), limits);
  }

  void range(const Key& key, std::string_view first, std::string_view second,
             std::optional<std::pair<double, double>>& value, const Limits& limits) override {
    const auto* node = find(key);
    if (!node) return;
    value.emplace();
    if (const auto* ends = node->as_table()) {
      scopes_.push_back({ends, path_of(key), {}});
      required_number({first, ""}, value->first, limits);
      required_number({second, ""}, value->second, limits);
      close_scope();
    } else if (read_number(*node, path_of(key), value->first, limits,
                           fmt::format(" or {{ {} = , {} = }}", first, second))) {
      value->second = value->first;
    }
  }

  void thermal(const Key& key, std::optional<ThermalRange>& value, const Limits& limits) override {
    const auto* node = find(key);
    if (!node) return;
    value.emplace();
    const auto* laws = node->as_table();
    if (!laws) {
      if (read_number(*node, path_of(key), value->cold, limits, " or a table such as { cold = , hot = }"))
        value->hot = value->cold;
      return;
    }
    scopes_.push_back({laws, path_of(key), {}});
    if (laws->contains("temperature_K") || laws->contains("values")) {
      value->law = ThermalLaw::table;
      numbers({"temperature_K", "rising temperatures"}, value->temperature, non_negative);
      numbers({"values", "one for each temperature"}, value->value, limits);
    } else if (laws->contains("reference") || laws->contains("reference_K") || laws->contains("rate_1_K")) {
      value->law = ThermalLaw::exponential;
      required_number({"reference", "the value at reference_K"}, value->reference, limits);
      required_number({"reference_K", "where the value is `reference`"}, value->reference_temperature, non_negative);
      required_number({"rate_1_K", "how fast it falls with temperature"}, value->rate, any_number);
    } else {
      required_number({"cold", ""}, value->cold, limits);
      required_number({"hot", ""}, value->hot, limits);
    }
    close_scope();
  }

  void table(const Key& key, bool* presence, const std::function<void()>& visit_keys) override {
    const auto* node = find(key);
    if (presence) *presence = node != nullptr;
    if (node && !node->is_table()) return wrong_type(*node, path_of(key), "a table");
    if (!node && presence) return;
    // A table that is not there is read as an empty one: it may have keys without a default.
    static const toml::table empty;
    errors_.places().locate(path_of(key), line_of(node ? node->source() : here().source()));
    scopes_.push_back({node ? node->as_table() : &empty, path_of(key), {}});
    visit_keys();
    close_scope();
  }

  void tables(const Key& key, const std::function<std::size_t()>&, const std::function<void(std::size_t)>& resize,
              const std::function<void(std::size_t)>& visit_entry) override {
    const auto* node = find(key);
    if (!node) return;
    const auto* array = node->as_array();
    if (!array || !array->is_homogeneous<toml::table>())
      return wrong_type(*node, path_of(key), fmt::format("tables, each headed [[{}]]", key.name));
    resize(array->size());
    for (std::size_t k = 0; k < array->size(); ++k) {
      const std::string path = fmt::format("{}.{}", path_of(key), k);
      errors_.places().locate(path, line_of(array->get(k)->source()));
      scopes_.push_back({array->get(k)->as_table(), path, {}});
      visit_entry(k);
      close_scope();
    }
  }

  /// Reports the keys of the innermost table that nobody asked for.
  void close_scope() {
    const Scope& scope = scopes_.back();
    for (const auto& [key, node] : *scope.table) {
      if (scope.known.contains(key.str())) continue;
      const std::string path =
          scope.path.empty() ? std::string(key.str()) : fmt::format("{}.{}", scope.path, key.str());
      errors_.places().locate(path, line_of(node.source()));
      errors_.add(path, fmt::format("unknown key; {}", suggest(key.str(), scope.known)));
    }
    scopes_.pop_back();
  }

 private:
  struct Scope {
    const toml::table* table;
    std::string path;
    std::set<std::string, std::less<>> known;
  };

  const toml::table& here() const { return *scopes_.back().table; }

  std::string path_of(const Key& key) const {
    return scopes_.back().path.empty() ? std::string(key.name) : fmt::format("{}.{}", scopes_.back().path, key.name);
  }

  static std::string suggest(std::string_view word, const std::set<std::string, std::less<>>& known) {
    const std::vector<std::string> words(known.begin(), known.end());
    if (const auto nearest = nearest_word(word, words)) return fmt::format("did you mean `{}`?", *nearest);
    return fmt::format("known here: {}", fmt::join(words, ", "));
  }

  const toml::node* find(const Key& key) {
    scopes_.back().known.emplace(key.name);
    const toml::node* node = here().get(key.name);
    if (node) errors_.places().locate(path_of(key), line_of(node->source()));
    return node;
  }

  const toml::node* require(const Key& key) {
    const toml::node* node = find(key);
    if (!node)
      errors_.add(path_of(key),
                  fmt::format("missing: {}", key.meaning.empty() ? "a value is needed here" : key.meaning));
    return node;
  }

  void numbers(const Key& key, std::vector<double>& values, const Limits& limits) {
    const auto* node = require(key);
    if (!node) return;
    const auto* array = node->as_array();
    if (!array) return wrong_type(*node, path_of(key), "an array of numbers");
    values.resize(array->size());
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!read_number(*array->get(k), fmt::format("{}[{}]", path_of(key), k), values[k], limits)) return;
  }

  void wrong_type(const toml::node& node, const std::string& path, std::string_view wanted) {
    errors_.add(path, fmt::format("must be {}, is {}", wanted, type_name(node)));
  }

  bool read_number(const toml::node& node, const std::string& path, double& value, const Limits& limits,
                   std::string_view alternative = {}) {
    if (!node.is_number()) {
      wrong_type(node, path, describe(limits, false) + std::string(alternative));
      return false;
    }
    value = *node.value<double>();
    if (!allowed(value, limits)) errors_.add(path, fmt::format("must be {}, is {}", describe(limits, false), value));
    return true;
  }

  void read_integer(const toml::node& node, const std::string& path, std::int64_t& value, const Limits& limits) {
    const auto i = node.value_exact<std::int64_t>();
    if (!i) return wrong_type(node, path, describe(limits, true));
    value = *i;
    if (!allowed(static_cast<double>(*i), limits))
      errors_.add(path, fmt::format("must be {}, is {}", describe(limits, true), *i));
  }

  void read_boolean(const toml::node& node, const std::string& path, bool& value) {
    if (const auto b = node.value_exact<bool>())
      value = *b;
    else
      wrong_type(node, path, "true or false");
  }

  void read_choice(const toml::node& node, const std::string& path, std::string& value,
                   const std::vector<std::string_view>& choices) {
    if (!read_text(node, path, value)) return;
    if (std::find(choices.begin(), choices.end(), value) == choices.end())
      errors_.add(path, fmt::format("\"{}\" is none of {}", value, fmt::join(choices, ", ")));
  }

  bool read_text(const toml::node& node, const std::string& path, std::string& value) {
    if (const auto s = node.value_exact<std::string>()) {
      value = *s;
      if (value.empty()) errors_.add(path, "must not be empty");
      return true;
    }
    wrong_type(node, path, "a text in quotes");
    return false;
  }

  void read_vector(const toml::node& node, const std::string& path, Vec3& value, const Limits& limits) {
    const auto* array = node.as_array();
    if (!array || array->size() != 3) return wrong_type(node, path, "an array of three numbers");
    for (std::size_t k = 0; k < 3; ++k)
      if (!read_number(*array->get(k), fmt::format("{}[{}]", path, k), value[static_cast<int>(k)], limits)) return;
  }

  SceneErrors& errors_;
  std::vector<Scope> scopes_;
};

// ----------------------------------------------------------------------------------------------------------- overrides

std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t dot = path.find('.');
    parts.emplace_back(path.substr(0, dot));
    if (dot == std::string_view::npos) return parts;
    path.remove_prefix(dot + 1);
  }
}

/// The table that holds the last key of the path, made where it is not there yet.
toml::table& table_at(toml::table& root, const std::vector<std::string>& parts, const std::string& text) {
  toml::table* table = &root;
  for (std::size_t k = 0; k + 1 < parts.size(); ++k) {
    toml::node* node = table->get(parts[k]);
    if (!node) {
      table->insert(parts[k], toml::table{});
      node = table->get(parts[k]);
    }
    if (auto* array = node->as_array()) {
      const std::string& index = parts[++k];
      char* end = nullptr;
      const unsigned long i = std::strtoul(index.c_str(), &end, 10);
      if (end == index.c_str() || *end || i >= array->size())
        fail("--set {}: \"{}\" must be a number below {}: which of the [[{}]]", text, index, array->size(),
             parts[k - 1]);
      node = array->get(i);
    }
    table = node->as_table();
    if (!table || k + 1 >= parts.size()) fail("--set {}: \"{}\" is not a table with keys of its own", text, parts[k]);
  }
  return *table;
}

void apply_override(toml::table& root, const std::string& text, SceneErrors& errors) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) fail("--set {}: must be key.path=value", text);
  const std::string path = text.substr(0, equals), value = text.substr(equals + 1);
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value, "--set " + text);
  } catch (const toml::parse_error&) {
    parsed.insert("value", value);
  }
  const auto parts = split_path(path);
  table_at(root, parts, text).insert_or_assign(parts.back(), *parsed.get("value"));
  errors.places().overridden(path, "--set " + text);
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  toml::table root = parse_toml_file(path);
  SceneErrors errors(path.string());
  for (const std::string& text : overrides) apply_override(root, text, errors);

  Scene scene;
  scene.file = path;
  scene.folder = std::filesystem::absolute(path).parent_path();
  set_defaults_for(root.at_path("shot.quality").value_or(std::string_view()), scene);
  SceneReader reader(root, errors);
  visit_scene(reader, scene);
  reader.close_scope();
  apply_quality(scene);
  validate_scene(scene, errors);
  errors.throw_if_any();
  scene.places = errors.places();
  return scene;
}

Scene read_surface_settings(const std::vector<std::string>& overrides) {
  toml::table root;
  SceneErrors errors("--set");
  for (const std::string& text : overrides) apply_override(root, text, errors);
  Scene scene;
  SceneReader reader(root, errors);
  visit_section(reader, scene, SceneSection::surface);
  reader.close_scope();
  errors.throw_if_any();
  return scene;
}

std::filesystem::path smelt_folder() {
  if (const char* folder = std::getenv("SMELT_FOLDER")) return folder;
  return SMELT_SOURCE_FOLDER;
}

std::filesystem::path find_mesh(const Scene& scene, const std::string& mesh) {
  const std::filesystem::path given = mesh;
  if (given.is_absolute()) {
    if (std::filesystem::is_regular_file(given)) return given;
    fail("there is no file {}", mesh);
  }
  for (const auto& folder : {scene.folder, smelt_folder()})
    if (std::filesystem::is_regular_file(folder / given)) return std::filesystem::weakly_canonical(folder / given);
  fail("there is no file \"{}\", neither in {} nor in {}", mesh, scene.folder.string(), smelt_folder().string());
}

}  // namespace smelt
