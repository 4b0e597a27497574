#include "bench/cases/reference.h"

#include "bench/bench_folder.h"
#include "core/error.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace smelt {

double Reference::at(double x, std::size_t c) const {
  CHECK_LT(c, column.size());
  const std::vector<double>& xs = column[0];
  const std::vector<double>& ys = column[c];
  const bool rising = xs.front() < xs.back();
  CHECK_GE(x, rising ? xs.front() : xs.back());
  CHECK_LE(x, rising ? xs.back() : xs.front());
  const auto above =
      std::find_if(xs.begin() + 1, xs.end() - 1, [&](double value) { return rising ? value >= x : value <= x; });
  const auto k = static_cast<std::size_t>(above - xs.begin());
  const double t = (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
  return (1.0 - t) * ys[k - 1] + t * ys[k];
}

Reference read_reference(const std::string& name) {
  const std::string path = bench_folder().string() + "/reference/" + name + ".csv";
  std::ifstream file(path);
  Reference reference;
  if (!std::getline(file, reference.header)) fail("{}: cannot be read", path);
  std::string line;
  for (int n = 2; std::getline(file, line); ++n) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      row.push_back(std::strtod(cell.c_str(), &end));
      if (cell.empty() || end != cell.c_str() + cell.size()) fail("{}:{}: \"{}\" is not a number", path, n, cell);
    }
    if (reference.column.empty()) reference.column.resize(row.size());
    if (row.size() != reference.column.size())
      fail("{}:{}: {} numbers where the rows before have {}", path, n, row.size(), reference.column.size());
    for (std::size_t c = 0; c < row.size(); ++c) reference.column[c].push_back(row[c]);
  }
  if (reference.column.size() < 2 || reference.column[0].size() < 2)
    fail("{}: needs two columns and two rows of numbers", path);
  return reference;
}

}  // namespace smelt
