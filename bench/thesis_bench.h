#pragma once
// The nine shots of [P table 6.2] in scenes/thesis: our seconds per iteration beside the table's.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace smelt {

/// A row of [P table 6.2].
struct ThesisShot {
  std::string name;  ///< the scene is scenes/thesis/<name>.toml
  std::size_t n_particles = 0;
  double seconds_per_step = 0.0;  ///< on a Pentium 4 of 2.4 GHz
};

/// In the table's order.
std::span<const ThesisShot> thesis_shots();

std::filesystem::path scene_file(const ThesisShot& shot);

struct ThesisBenchResult {
  std::size_t n_particles = 0;
  double seconds_per_step = 0.0;  ///< mean
};

/// Times steps of a shot after a short warm-up, which of a scene that pours lasts until all is poured. Throws Error
/// where its scene cannot be used, DivergedError as the solver does.
ThesisBenchResult bench_thesis_shot(const ThesisShot& shot);

}  // namespace smelt
