#pragma once
// Many pictures on one page.

#include "core/image.h"

#include <vector>

namespace smelt {

/// Pictures of the same size in rows of `n_columns`, each made smaller by averaging its light so that the page is at
/// most `max_width` pixels wide, on white with a narrow gap. Places left over stay white. Throws Error where sizes
/// differ.
ImageRgb8 make_contact_sheet(const std::vector<ImageRgb8>& pictures, int n_columns, int max_width = 1920);

}  // namespace smelt
