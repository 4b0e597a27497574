#pragma once
// What every accuracy test needs: a reference, norms, an order of convergence, and a place for the measured figure.

#include "bench/cases/norms.h"
#include "bench/cases/reference.h"

#include <optional>
#include <string>

namespace smelt {

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
