#include "tests/source_folder.h"

namespace smelt {

std::filesystem::path source_folder() {
  return SMELT_SOURCE_DIR;
}

}  // namespace smelt
