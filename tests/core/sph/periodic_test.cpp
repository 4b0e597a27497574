#include "core/sph/periodic.h"

#include "core/error.h"
#include "core/sph/solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>
#include <set>

namespace smelt {
namespace {

constexpr double spacing = 0.05;

template <int Dim>
Box<Dim> unit_box() {
  Box<Dim> box;
  box.lower.setZero();
  box.upper.setOnes();
  return box;
}

template <int Dim>
std::vector<Vec<Dim>> random_points(std::size_t n, unsigned seed, double lower = 0.0, double upper = 1.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(lower, upper);
  std::vector<Vec<Dim>> points(n);
  for (auto& x : points)
    for (int a = 0; a < Dim; ++a) x[a] = uniform(random);
  return points;
}

TEST(Periodic, WrapPutsEveryPointIntoTheBoxAndLeavesThoseInsideAlone) {
  Box<2> box = unit_box<2>();
  box.lower[1] = 1.0;
  box.upper[1] = 0.0;  // the second axis does not repeat
  std::vector<Vec<2>> x = {{0.3, 7.0}, {1.25, -4.0}, {-0.25, 0.0}, {1.0, 0.0}, {-1e-20, 0.0}, {3.5, 0.0}, {0.0, 0.0}};
  wrap_positions<2>(box, x);
  const std::vector<Vec<2>> expected = {{0.3, 7.0}, {0.25, -4.0}, {0.75, 0.0}, {0.0, 0.0},
                                        {0.0, 0.0}, {0.5, 0.0},   {0.0, 0.0}};
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(x[i], expected[i]) << i;
}

/// Every row holds each neighbour once, at the nearest image's place, in agreement with a search over all pairs.
template <int Dim>
void expect_all_pairs(const Box<Dim>& box, double radius, std::size_t n) {
  std::vector<Vec<Dim>> points = random_points<Dim>(n, 21);
  std::vector<std::int32_t> id(n);
  std::iota(id.begin(), id.end(), 0);
  const auto order = compute_cell_order<Dim>(points, id, radius);
  std::vector<Vec<Dim>> sorted;
  for (const auto i : order) sorted.push_back(points[i]);
  NeighbourLists lists;
  const auto images = build_periodic_neighbour_lists<Dim>(box, sorted, order, radius, 8, lists);
  ASSERT_EQ(lists.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    std::set<std::int32_t> expected;
    for (std::size_t j = 0; j < n; ++j) {
      Vec<Dim> x = sorted[i] - sorted[j];
      for (int a = 0; a < Dim; ++a)
        if (is_periodic(box, a)) x[a] -= std::round(x[a] / box.extent()[a]) * box.extent()[a];
      if (j != i && x.norm() < radius) expected.insert(static_cast<std::int32_t>(j));
    }
    std::set<std::int32_t> found;
    for (const auto j : lists.row(i)) {
      const bool image = static_cast<std::size_t>(j) >= n;
      const auto source = image ? images.source[j - n] : j;
      const Vec<Dim> x = sorted[source] + (image ? images.shift[j - n] : Vec<Dim>(Vec<Dim>::Zero()));
      EXPECT_LT((sorted[i] - x).norm(), radius);
      EXPECT_TRUE(found.insert(source).second) << "particle " << i << " sees " << source << " twice";
    }
    ASSERT_EQ(found, expected) << "particle " << i;
    std::vector<std::int32_t> buffer(lists.room());
    const NeighbourLists::Row row = lists.read(i, buffer.data());
    for (const auto k : row.padded.subspan(row.neighbours.size())) ASSERT_EQ(k, static_cast<std::int32_t>(i));
  }
}

TEST(Periodic, NeighboursMatchBruteForce) {
  expect_all_pairs<1>(unit_box<1>(), 0.11, 100);
  expect_all_pairs<2>(unit_box<2>(), 0.2, 300);
  expect_all_pairs<3>(unit_box<3>(), 0.33, 400);
  Box<3> slab = unit_box<3>();
  slab.lower[1] = 1.0;
  slab.upper[1] = -1.0;
  expect_all_pairs<3>(slab, 0.33, 400);
}

TEST(Periodic, RefusesABoxInWhichAParticleMeetsItsNeighbourTwice) {
  EXPECT_NO_THROW(check_period<2>(unit_box<2>(), 0.5));
  EXPECT_THROW(check_period<2>(unit_box<2>(), 0.51), Error);
}

Material clay() {
  Material m{"clay", 1000.0, {}, HeatProperties{1e-3, 250.0, 350.0}};
  m.rheology.yield_stress = {100.0, 100.0};
  m.rheology.consistency = {50.0, 50.0};
  m.rheology.index = 0.5;
  m.rheology.jump_number = ThermalRange{1000.0, 1000.0};
  return m;
}

/// A lattice that fills a unit box, every term of the pair loops in use.
template <int Dim>
Particles<Dim> make_lattice(double jitter, double speed) {
  Particles<Dim> p;
  std::mt19937 random(23);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int n = 20;
  for (int k = 0; k < (Dim == 3 ? n : 1); ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        Vec<Dim> x, v;
        x[0] = i + 0.5;
        x[1] = j + 0.5;
        if constexpr (Dim == 3) x[2] = k + 0.5;
        for (int a = 0; a < Dim; ++a) x[a] = (x[a] + jitter * uniform(random)) * spacing;
        for (int a = 0; a < Dim; ++a) v[a] = speed * uniform(random);
        p.id.push_back(static_cast<std::int32_t>(p.id.size()));
        p.position.push_back(x);
        p.velocity.push_back(v);
        p.density.push_back(1000.0 + (jitter > 0.0 ? 5.0 * uniform(random) : 5.0));
        p.temperature.push_back(300.0 + (jitter > 0.0 ? 20.0 * uniform(random) : 0.0));
      }
  return p;
}

template <int Dim>
SolverParameters<Dim> make_parameters() {
  SolverParameters<Dim> parameters;
  parameters.particle_volume = std::pow(spacing, Dim);
  parameters.smoothing_length = 1.2 * spacing;
  parameters.sound_speed = parameters.shear_wave_speed = 20.0;
  parameters.artificial_viscosity = 0.3;
  parameters.xsph = 0.3;
  parameters.period = unit_box<Dim>();
  return parameters;
}

template <int Dim, typename Real>
void run_until(Solver<Dim, Real>& solver, double end) {
  solver.prepare();
  for (double remaining = end; remaining > 0.0;) remaining -= solver.step(remaining, end - remaining).dt;
}

TEST(Periodic, ListsReachAsFarAsTheKernel) {
  for (const auto& [kernel, n_neighbours] :
       {std::pair{KernelType::cubic_spline, 20U}, std::pair{KernelType::quintic_spline, 44U}}) {
    auto parameters = make_parameters<2>();
    parameters.kernel = kernel;
    Solver<2, double> solver(parameters, {clay()}, {}, make_lattice<2>(0.0, 0.0));
    solver.prepare();
    // (2 + 0.08) 1.2 = 2.5 and (3 + 0.08) 1.2 = 3.7 spacings.
    EXPECT_EQ(solver.neighbours().row(0).size(), n_neighbours);
    for (std::size_t i = 0; i < solver.particles().size(); ++i) ASSERT_LT(solver.acceleration(i).norm(), 1e-9);
  }
}

// Without images the lattice's faces are free surfaces and its sums there are anything but those of the middle.
TEST(Periodic, LatticeHasNoSurface) {
  Solver<3, double> solver(make_parameters<3>(), {clay()}, {}, make_lattice<3>(0.0, 0.0));
  solver.prepare();
  const auto& lists = solver.neighbours();
  for (std::size_t i = 0; i < solver.particles().size(); ++i) {
    ASSERT_EQ(lists.row(i).size(), lists.row(0).size());
    // p/rho^2 grad W of one neighbour is some 10^2 m/s^2 here.
    ASSERT_LT(solver.acceleration(i).norm(), 1e-9);
  }
  run_until(solver, 0.05);
  for (std::size_t i = 0; i < solver.particles().size(); ++i) ASSERT_NEAR(solver.particles().density[i], 1005.0, 1e-9);
}

TEST(Periodic, StreamKeepsMomentumHeatAndNames) {
  Particles<2> p = make_lattice<2>(0.2, 0.3);
  for (auto& v : p.velocity) v += Vec<2>(4.0, -2.0);
  const auto parameters = make_parameters<2>();
  Solver<2, double> solver(parameters, {clay()}, {}, p);
  const auto sums = [&] {
    Eigen::Vector4d s = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
      s.head<2>() += solver.particles().velocity[i];
      s[2] += solver.particles().temperature[i];
      s[3] += solver.particles().velocity[i].norm();
    }
    return s;
  };
  const auto before = sums();
  run_until(solver, 0.4);  // 1.6 boxes to the right, 0.8 down
  const auto after = sums();
  EXPECT_LT((after - before).head<2>().norm() / before[3], 1e-12);
  EXPECT_NEAR(after[2] / before[2], 1.0, 1e-12);
  const auto& q = solver.particles();
  std::set<std::int32_t> ids(q.id.begin(), q.id.end());
  EXPECT_EQ(ids.size(), p.size());
  // XSPH smooths what particles move with but keeps its mean.
  const Vec<2> way = 0.4 * before.head<2>() / static_cast<double>(p.size());
  Vec<2> mean_off = Vec<2>::Zero();
  for (std::size_t i = 0; i < q.size(); ++i) {
    // Until the next search a particle may be outside by what the lists' skin allows.
    const double slack = 0.5 * 0.08 * parameters.smoothing_length;
    ASSERT_GE(q.position[i].minCoeff(), -slack);
    ASSERT_LE(q.position[i].maxCoeff(), 1.0 + slack);
    // Each is, modulo the box, near where the stream carried it.
    Vec<2> off = q.position[i] - p.position[static_cast<std::size_t>(q.id[i])] - way;
    for (int a = 0; a < 2; ++a) off[a] -= std::round(off[a]);
    mean_off += off / static_cast<double>(q.size());
    ASSERT_LT(off.norm(), 3.0 * spacing) << "particle " << q.id[i];
  }
  EXPECT_LT(mean_off.norm(), 1e-11);
}

/// Accelerations by id after `shift`ing all particles, wrapped.
template <typename Real>
std::vector<Vec3> shifted_acceleration(const Vec3& shift) {
  Particles<3> p = make_lattice<3>(0.2, 0.3);
  for (auto& x : p.position) x += shift;
  Solver<3, Real> solver(make_parameters<3>(), {clay()}, {}, p);
  solver.prepare();
  std::vector<Vec3> by_id(p.size());
  for (std::size_t i = 0; i < p.size(); ++i)
    by_id[static_cast<std::size_t>(solver.particles().id[i])] = solver.acceleration(i);
  return by_id;
}

template <typename Real>
void expect_no_place_is_special(double tolerance) {
  const auto here = shifted_acceleration<Real>(Vec3::Zero());
  const auto there = shifted_acceleration<Real>(Vec3(0.37, -0.81, 2.53));
  double scale = 0.0, worst = 0.0;
  for (std::size_t i = 0; i < here.size(); ++i) {
    scale = std::max(scale, here[i].norm());
    worst = std::max(worst, (here[i] - there[i]).norm());
  }
  EXPECT_GT(scale, 1.0);
  EXPECT_LT(worst / scale, tolerance);
}

TEST(Periodic, NoPlaceIsSpecialInDouble) {
  expect_no_place_is_special<double>(1e-12);
}
TEST(Periodic, NoPlaceIsSpecialInSingle) {
  expect_no_place_is_special<float>(1e-5);
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

Particles<2> run_on_threads(int threads, bool resume) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Particles<2> p = make_lattice<2>(0.2, 0.3);
  for (auto& v : p.velocity) v[0] += 5.0;
  Solver<2, double> first(make_parameters<2>(), {clay()}, {}, p);
  run_until(first, 0.05);
  Solver<2, double> second(make_parameters<2>(), {clay()}, {}, first.particles());
  Solver<2, double>& last = resume ? second : first;
  run_until(last, 0.05);
  return last.particles();
}

TEST(Periodic, SameBytesOnAnyThreadsAndAfterAResume) {
  const Particles<2> one = run_on_threads(1, false);
  for (const Particles<2>& other : {run_on_threads(2, false), run_on_threads(2, true)}) {
    EXPECT_TRUE(same_bytes(one.id, other.id));
    EXPECT_TRUE(same_bytes(one.position, other.position));
    EXPECT_TRUE(same_bytes(one.velocity, other.velocity));
    EXPECT_TRUE(same_bytes(one.density, other.density));
    EXPECT_TRUE(same_bytes(one.temperature, other.temperature));
    EXPECT_TRUE(same_bytes(one.stress, other.stress));
  }
}

}  // namespace
}  // namespace smelt
