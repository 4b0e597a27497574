#pragma once
// A problem with a known answer, as the report sees it: what to run, and what a run shows.

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace smelt {

/// y over x; a reference has a row for each.
struct Curve {
  std::vector<double> x, y;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

/// What was computed beside what should have been, in the units of the axes.
struct Profile {
  Curve computed;
  Curve reference;
};

/// Points coloured by a value: a flow, say.
struct Picture {
  std::string caption;
  std::string x_label, y_label, value_label;       ///< with units
  std::vector<double> x = {}, y = {}, value = {};  ///< of one length
};

/// One run at one resolution.
struct Measurement {
  double error = 0.0;        ///< as the case says, positive
  double cpu_seconds = 0.0;  ///< of the computation alone, without what measures its error
  std::size_t n_particles = 0;
  std::optional<Profile> profile = std::nullopt;
  std::optional<Picture> picture = std::nullopt;
};

struct Case {
  std::string name;  ///< on the command line
  std::string title;
  std::string measures;                        ///< one sentence
  std::string good;                            ///< one sentence: what a good number is
  std::vector<double> good_errors;             ///< the same as numbers: one a method, or one for all of them
  std::string error_label;                     ///< of the axis, with its unit
  std::string resolution_label;                ///< what is counted: "particles across the channel"
  std::string profile_x = {}, profile_y = {};  ///< axes of the profiles, with units; empty without profiles
  std::vector<std::string> methods;            ///< each is a line of the plots
  std::vector<double> quick, full;             ///< resolutions, ascending
  /// Computes with methods[method] at a resolution, on the calling thread where it is in a tbb::task_arena of one.
  /// Throws where it cannot.
  std::function<Measurement(std::size_t method, double resolution)> run;

  double good_error(std::size_t method) const { return good_errors.at(good_errors.size() == 1 ? 0 : method); }
};

}  // namespace smelt
