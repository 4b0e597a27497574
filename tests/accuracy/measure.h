#pragma once
// What every accuracy test needs: a reference, norms, an order of convergence, and a place for the measured figure.

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace smelt {

/// A reference solution of tests/data/reference, column by column.
struct Reference {
  std::string header;                       ///< first line of the file: names and units, in the file's own words
  std::vector<std::vector<double>> column;  ///< all of one length

  /// Column `c` at `x` by linear interpolation over column 0, which must rise or fall strictly. Throws InternalError
  /// where `x` lies outside the table: a reference is never extended.
  double at(double x, std::size_t c = 1) const;
};

/// Reads tests/data/reference/`name`.csv. Throws Error (file:line) where it cannot be read or a row has another length.
Reference read_reference(const std::string& name);

/// Unweighted norms of differences e_1 .. e_n: sum |e|/n, sqrt(sum e^2/n), max |e|. Throws InternalError where there
/// are none.
struct Norms {
  double l1 = 0.0;
  double l2 = 0.0;
  double max = 0.0;
};
Norms compute_norms(std::span<const double> differences);

/// p of error = C spacing^p, by least squares in the logarithms. Throws InternalError for fewer than two values or ones
/// <= 0.
double convergence_order(std::span<const double> spacing, std::span<const double> error);

/// One measured figure: a row of docs/accuracy.md. Texts hold no comma, quotation mark or bar (CHECKed).
struct Row {
  std::string problem;                               ///< what flows
  std::string quantity;                              ///< what is compared, with its norm and unit
  std::string resolution;                            ///< particles across, as text
  double error = 0.0;                                ///< measured
  std::optional<double> bar = std::nullopt;          ///< `error` must not exceed it
  std::optional<double> order = std::nullopt;        ///< measured order of convergence
  std::optional<double> least_order = std::nullopt;  ///< `order` must not be below it
};

/// Prints the row, and adds it to `Suite.Test.csv` in the folder $SMELT_ACCURACY_FOLDER if that is set. Fails the
/// running test where the error exceeds its bar (or is not a number) or the order is too low, so that the table and the
/// test cannot disagree.
void report_row(const Row& row);

/// Whether $SMELT_FULL asks for full resolution (`./smelt test --full`); a shorter version runs else.
bool full_run();

}  // namespace smelt
