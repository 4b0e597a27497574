#pragma once

#include <string_view>

namespace smelt {

inline constexpr std::string_view version = SMELT_VERSION;

}  // namespace smelt
