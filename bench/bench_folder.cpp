#include "bench/bench_folder.h"

namespace smelt {

std::filesystem::path bench_folder() {
  return SMELT_BENCH_FOLDER;
}

}  // namespace smelt
