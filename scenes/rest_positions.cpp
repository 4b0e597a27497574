#include "scenes/rest_positions.h"

#include "core/error.h"

#include <limits>

namespace smelt {

RestPositions::RestPositions(const SolverParameters<3>& parameters) {
  for (const Emitter<3>& e : parameters.emitters) {
    const auto layers = compute_emitter_layers(e, parameters.particle_volume,
                                               kernel_kappa(parameters.kernel) * parameters.smoothing_length);
    vents_.push_back({e.position, layers.speed * e.direction, e.start});
  }
}

Vec3 RestPositions::column_position(const Vec3& x, double time) const {
  const Vent* nearest = nullptr;
  double best = std::numeric_limits<double>::infinity();
  for (const Vent& vent : vents_) {
    const double distance = (x - vent.position).norm();
    if (distance >= best) continue;
    nearest = &vent;
    best = distance;
  }
  CHECK(nearest != nullptr);
  return x - nearest->velocity * (time - nearest->start);
}

void RestPositions::set_rest(ParticleFrame& frame) {
  std::unordered_map<std::int32_t, Vec3f> present;
  present.reserve(frame.size());
  frame.rest.clear();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const auto old = known_.find(frame.id[i]);
    Vec3f rest;
    if (old != known_.end())
      rest = old->second;
    else if (frame.time == 0.0)
      rest = frame.position[i].cast<float>();
    else
      rest = column_position(frame.position[i], frame.time).cast<float>();
    present.emplace(frame.id[i], rest);
    frame.rest.push_back(rest);
  }
  known_ = std::move(present);  // what flowed out is forgotten
}

void RestPositions::take_over(const ParticleFrame& frame) {
  if (frame.rest.size() != frame.size())
    fail("frame {} has no rest positions, though the scene asks for them; simulate without --resume", frame.frame);
  known_.clear();
  for (std::size_t i = 0; i < frame.size(); ++i) known_.emplace(frame.id[i], frame.rest[i]);
}

}  // namespace smelt
