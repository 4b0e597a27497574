#pragma once
// One description of the scene file, visited by its reader, its writer and the maker of its reference page.

#include "core/geometry/vec.h"
#include "core/sph/material.h"
#include "scenes/scene.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace smelt {

/// Allowed values of a number; the bounds themselves are allowed unless `open_lower`.
struct Limits {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open_lower = false;
};
inline constexpr Limits any_number{};
inline constexpr Limits positive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Limits non_negative{0.0, std::numeric_limits<double>::infinity(), false};
inline constexpr Limits unit_interval{0.0, 1.0, false};

/// A key: its name (with the unit as a suffix), what it means, and, where no default value says it, what happens
/// without it.
struct Key {
  std::string_view name;
  std::string_view meaning;
  std::string_view without = {};
};

/// Visits the keys of a scene in order. A value holds its default when it is visited; an optional without a value has
/// none.
class SchemaVisitor {
 public:
  virtual ~SchemaVisitor() = default;

  virtual void number(const Key& key, double& value, const Limits& limits) = 0;
  virtual void number(const Key& key, std::optional<double>& value, const Limits& limits) = 0;
  virtual void required_number(const Key& key, double& value, const Limits& limits) = 0;
  virtual void integer(const Key& key, std::int64_t& value, const Limits& limits) = 0;
  virtual void integer(const Key& key, std::optional<std::int64_t>& value, const Limits& limits) = 0;
  virtual void required_integer(const Key& key, std::int64_t& value, const Limits& limits) = 0;
  virtual void boolean(const Key& key, bool& value) = 0;
  virtual void boolean(const Key& key, std::optional<bool>& value) = 0;
  virtual void required_text(const Key& key, std::string& value) = 0;
  /// A text that may be left out; empty then.
  virtual void optional_text(const Key& key, std::string& value) = 0;
  virtual void choice(const Key& key, std::string& value, const std::vector<std::string_view>& choices) = 0;
  virtual void choice(const Key& key, std::optional<std::string>& value,
                      const std::vector<std::string_view>& choices) = 0;
  virtual void vector(const Key& key, Vec3& value, const Limits& limits) = 0;
  virtual void vector(const Key& key, std::optional<Vec3>& value, const Limits& limits) = 0;
  /// A number, or { first = , second = } for the two ends of a range.
  virtual void range(const Key& key, std::string_view first, std::string_view second,
                     std::optional<std::pair<double, double>>& value, const Limits& limits) = 0;
  /// A number that may follow temperature: a number, { cold = , hot = }, { temperature_K = [], values = [] } or
  /// { reference = , reference_K = , rate_1_K = }. `limits` are those of the value.
  virtual void thermal(const Key& key, std::optional<ThermalRange>& value, const Limits& limits) = 0;
  /// A table; where `presence` is given the table may be left out, and *presence says whether it is there.
  virtual void table(const Key& key, bool* presence, const std::function<void()>& visit_keys) = 0;
  /// [[name]]: `resize` makes n entries, `visit_entry(k)` visits one of `size()`.
  virtual void tables(const Key& key, const std::function<std::size_t()>& size,
                      const std::function<void(std::size_t)>& resize,
                      const std::function<void(std::size_t)>& visit_entry) = 0;
};

/// Visits every key of `scene`, section by section in the order of docs/scene.md.
void visit_scene(SchemaVisitor& visitor, Scene& scene);

/// Which part of a scene a stage depends on.
enum class SceneSection { simulation, surface, render };

/// Visits only the keys that change what a stage makes.
void visit_section(SchemaVisitor& visitor, Scene& scene, SceneSection section);

}  // namespace smelt
