#pragma once
// `smelt report`: speed against error, as a page.

#include "bench/report/report.h"

#include <CLI/CLI.hpp>

#include <functional>

namespace smelt {

/// Adds the command; where it is given, `work` is set to what makes the report that `options` ask for.
void add_report(CLI::App& app, ReportOptions& options, std::function<void()>& work);

}  // namespace smelt
