#pragma once
// `smelt bench`: how fast this machine is, as text or JSON on stdout.

#include <cstddef>
#include <string>

namespace smelt {

/// The full melting step of a heap of about `n_particles`: "X.XX million particle-steps/s", and what stands behind it.
void print_step_bench(std::size_t n_particles, bool as_json);

/// Bytes a particle and seconds a step of scenes that ask for ever more terms.
void print_terms_bench(std::size_t n_particles, bool as_json);

/// Seconds per iteration of the shots of [P table 6.2] beside the table's; of the one named `only`, of all nine where
/// it is empty.
void print_thesis_bench(const std::string& only, bool as_json);

/// `./smelt bench pairs`: the pair loops beside what a core can do.
void print_pairs_bench(std::size_t n_particles, bool as_json);

}  // namespace smelt
