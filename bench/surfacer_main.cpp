// The surfacer's timings alone.
//   bench_surfacer [large]      with 10 million particles too

#include "bench/surfacer_bench.h"

#include <cstdio>
#include <string_view>

int main(int argc, char** argv) {
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  return smelt::bench_surfacer(argc > 1 && std::string_view(argv[1]) == "large") ? 0 : 1;
}
