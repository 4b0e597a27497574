#pragma once
// The report as one HTML page that needs nothing else.

#include "bench/report/suite.h"

#include <filesystem>
#include <string>
#include <vector>

namespace smelt {

/// What the page says at its top.
struct PageHead {
  std::string machine;  ///< processor and cores
  std::string version;  ///< of smelt
  std::string date;
  std::string command;  ///< that makes this page
  bool quick = false;
};

/// Processor and cores of this machine, as Linux names them.
std::string describe_machine();

/// This moment as "2026-01-31 12:34 UTC".
std::string describe_now();

/// The order of convergence of one method's runs, error = C resolution^-p by least squares; nothing where fewer than
/// two went well.
std::optional<double> fitted_order(const std::vector<Run>& runs, std::size_t method);

/// A part of the page.
struct Section {
  std::string summary;  ///< its rows of the table at the top of the page
  std::string body;     ///< a `<section>` element
};

/// A case: what it measures, its plots and figures, how to repeat it, and what failed. Draws with gnuplot in `folder`.
Section write_case_section(const CaseResult& result, bool quick, const std::filesystem::path& folder);

/// The whole page; `n_expected` sections will be in it when it is complete.
std::string write_page(const PageHead& head, const std::vector<Section>& sections, std::size_t n_expected);

}  // namespace smelt
