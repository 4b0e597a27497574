#include "bench/cases/all_cases.h"

#include "bench/cases/cavity.h"
#include "bench/cases/dam_break.h"
#include "bench/cases/furnace.h"
#include "bench/cases/gravity_current.h"
#include "bench/cases/heat_step.h"
#include "bench/cases/hydrostatic_pool.h"
#include "bench/cases/knobs.h"
#include "bench/cases/poiseuille.h"
#include "bench/cases/rigid_rotation.h"
#include "bench/cases/shock_tube.h"
#include "bench/cases/slope.h"
#include "bench/cases/slump.h"
#include "bench/cases/smd_channel.h"
#include "bench/cases/stefan.h"
#include "bench/cases/surfacing.h"
#include "bench/cases/water_discharge.h"

namespace smelt {

std::vector<Case> all_cases() {
  return {smd_channel::make_case(),
          poiseuille::make_case(),
          heat_step::make_case(),
          stefan::make_case(),
          shock_tube::make_case(),
          cavity::make_case(),
          hydrostatic_pool::make_case(),
          dam_break::make_case(),
          water_discharge::make_case(),
          slump::make_case(),
          slope::make_case(),
          rigid_rotation::make_case(),
          gravity_current::make_plane_case(),
          gravity_current::make_axisymmetric_case(),
          gravity_current::make_benchmark_case(),
          surfacing_cases::make_sphere_case(),
          surfacing_cases::make_bunny_case(),
          furnace::make_black_body_case(),
          furnace::make_furnace_case(),
          knobs::make_flow_case(),
          knobs::make_surface_case()};
}

}  // namespace smelt
