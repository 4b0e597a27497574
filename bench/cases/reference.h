#pragma once
// Solutions to compare with: exact, converged or experimental  (bench/reference/README.md).

#include <string>
#include <vector>

namespace smelt {

/// A reference solution of bench/reference, column by column.
struct Reference {
  std::string header;                       ///< first line of the file: names and units, in the file's own words
  std::vector<std::vector<double>> column;  ///< all of one length

  /// Column `c` at `x` by linear interpolation over column 0, which must rise or fall strictly. Throws InternalError
  /// where `x` lies outside the table: a reference is never extended.
  double at(double x, std::size_t c = 1) const;
};

/// Reads `name`.csv of bench/reference, where this program was built. Throws Error (file:line) where it cannot be read
/// or a row has another length.
Reference read_reference(const std::string& name);

}  // namespace smelt
