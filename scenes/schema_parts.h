#pragma once
// The parts that visit_scene (scenes/schema.h) puts together, and what they share.

#include "scenes/schema.h"

namespace smelt {

/// Every table that changes what is simulated.
void visit_simulation(SchemaVisitor& v, Scene& s);

/// [surface].
void visit_surface(SchemaVisitor& v, Scene& s);

/// [camera], [[light]], [look], [environment] and [render].
void visit_render(SchemaVisitor& v, Scene& s);

// Adapters between the visitor's types and the settings' own.

inline void visit_int(SchemaVisitor& v, const Key& key, int& value, const Limits& limits, bool required = false) {
  std::int64_t wide = value;
  required ? v.required_integer(key, wide, limits) : v.integer(key, wide, limits);
  value = static_cast<int>(wide);
}

template <typename T>
void visit_tables(SchemaVisitor& v, const Key& key, std::vector<T>& values, const std::function<void(T&)>& visit) {
  v.tables(
      key, [&] { return values.size(); }, [&](std::size_t n) { values.resize(n); },
      [&](std::size_t k) { visit(values[k]); });
}

}  // namespace smelt
