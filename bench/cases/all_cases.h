#pragma once

#include "bench/cases/case.h"

#include <vector>

namespace smelt {

/// Every case of the report, in its order.
std::vector<Case> all_cases();

}  // namespace smelt
