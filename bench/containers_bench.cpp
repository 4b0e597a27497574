// The whole size of tests/stability/containers_test.cpp: 10^5 spheres for 10^4 steps in each container. Some 80 minutes
// on two cores at the rates of docs/performance.md.
//   bench_containers [spheres] [steps] [container] [seed]

#include "tests/stability/containers.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  using namespace smelt;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  ShakeOptions options;
  options.n_particles = argc > 1 ? std::atoi(argv[1]) : 100000;
  options.n_steps = argc > 2 ? std::atoi(argv[2]) : 10000;
  options.seed = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 1;
  fmt::print(
      "| container | triangles | spheres | steps | lost | deepest / radius | moves that hit | way of a step / radius | "
      "us a move |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  bool sound = true;
  std::string names;
  int n_shaken = 0;
  for (const auto& make : {make_closed_box, make_funnel, make_sieve, make_bowl, make_dragon}) {
    const Container container = make();
    names += " " + container.name;
    if (argc > 3 && container.name != argv[3]) continue;
    ++n_shaken;
    const Shaken seen = shake(container, options);
    fmt::print("| {} | {} | {} | {} | {} | {:.2g} | {:.1f} % | {:.2f} | {:.2f} |\n", container.name,
               container.facets.size(), seen.n_particles, options.n_steps, seen.n_lost, seen.deepest, 100.0 * seen.hits,
               seen.way, 1e6 * seen.seconds / (static_cast<double>(seen.n_particles) * options.n_steps));
    sound = sound && seen.n_lost == 0 && seen.deepest < 1e-6;
  }
  if (n_shaken == 0) {
    fmt::print(stderr, "bench_containers: there is no container \"{}\"; there are{}\n", argv[3], names);
    return 2;
  }
  return sound ? 0 : 1;
}
