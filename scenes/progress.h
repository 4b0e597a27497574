#pragma once
// How a long run talks to whoever started it.

#include <string>

namespace smelt {

/// Where a stage is.
struct ProgressState {
  std::string stage;  ///< "simulate", "surface", "render"
  int frame = 0;      ///< being worked on
  int first_frame = 1;
  int last_frame = 1;
  double fraction = 0.0;  ///< of the frame that is done, in [0, 1]
  std::string details;    ///< step count and time step, say
};

/// Handed in by the caller; the default stays silent and never stops.
class Progress {
 public:
  virtual ~Progress() = default;
  virtual void update(const ProgressState&) {}
  virtual void message(const std::string&) {}
  /// Whether the user wants to stop: the stage then ends with Interrupted after what it holds is safe.
  virtual bool should_stop() { return false; }
};

}  // namespace smelt
