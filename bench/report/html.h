#pragma once
// Pieces of the page.

#include <string>

namespace smelt {

/// The text with what HTML would read as markup escaped.
std::string escape_html(const std::string& text);

/// An `<svg>` element over its caption.
std::string write_figure(const std::string& svg, const std::string& caption);

}  // namespace smelt
