#include "surfacing/smooth_mesh.h"

#include "core/error.h"
#include "core/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace smelt {

namespace {

constexpr float step = 0.8f;
constexpr std::size_t grain = 2048;

/// A displacement in a register; the fourth lane is 0.
using Displacement = Eigen::Vector4f;

template <typename Body>
void for_each_vertex(std::size_t n, Body&& body) {
  parallel_blocks(
      n,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) body(v);
      },
      grain);
}

/// mean of neighbours - own value
template <typename Vector>
Vector umbrella(const VertexNeighbours& near, const std::vector<Vector>& x, std::size_t v) {
  Vector sum = Vector::Zero();
  for (std::uint32_t n = near.begin[v]; n < near.begin[v + 1]; ++n) sum += x[near.neighbour[n]];
  using Scalar = typename Vector::Scalar;
  return sum / static_cast<Scalar>(near.begin[v + 1] - near.begin[v]) - x[v];
}

/// One step x_k+1 = x_k + momentum (x_k - x_k-1) + factor s L x_k, L the umbrella.
struct Step {
  float momentum, factor;
};

/// Steps that do what `passes` steps x += 0.8 s L x do, in fewer: their polynomial p(t) in t, an eigenvalue of -s L,
/// has the slope -0.8 passes at t = 0, so long waves are damped alike, and stays below 1 % on the rest of [0, 2], where
/// the eigenvalues lie. That is T_n(z(t))/T_n(z(0)), z(t) = (2 + a - 2 t)/(2 - a), T_n Chebyshev's polynomial, which of
/// all polynomials does it in the fewest steps [Varga 1962]: about 2 sqrt(passes). By its three-term recurrence every
/// step is such a polynomial itself, 1 at most on [0, 2]: nothing grows on the way, however many there are. The same
/// product by its roots, from both ends in turn, multiplies rounding by 4e3 at 100 passes.
std::vector<Step> smoothing_steps(int passes) {
  constexpr double ripple = 0.01;
  const double slope = static_cast<double>(step) * passes, decay = std::acosh(1.0 / ripple);
  for (int n = 2; n < passes; ++n) {
    // |p| = ripple at the ends of [a, 2]: cosh(n theta) = 1/ripple with cosh(theta) = z(0).
    const double theta = decay / n, a = 2.0 * (std::cosh(theta) - 1.0) / (std::cosh(theta) + 1.0);
    if (n * std::tanh(decay) / std::sinh(theta) * 2.0 / (2.0 - a) < slope) continue;
    // With r_k = T_k(z(0))/T_k+1(z(0)): p_k+1 = 2 z r_k p_k - r_k r_k-1 p_k-1.
    std::vector<Step> steps = {{0.0f, static_cast<float>(2.0 / (2.0 + a))}};
    for (int k = 1; k < n; ++k) {
      const double before = std::cosh((k - 1) * theta), now = std::cosh(k * theta), next = std::cosh((k + 1) * theta);
      steps.push_back({static_cast<float>(before / next), static_cast<float>(4.0 / (2.0 - a) * now / next)});
    }
    return steps;
  }
  return std::vector<Step>(static_cast<std::size_t>(passes), Step{0.0f, step});
}

/// Runs the steps on x, with a constant source added to the umbrella: source + L x.
void apply_steps(std::vector<Displacement>& x, const std::vector<Displacement>* source, const VertexNeighbours& near,
                 std::span<const float> strength, std::span<const Step> steps) {
  std::vector<Displacement> before = x;  // overwritten by what comes next: a vertex reads its own entry alone
  for (const Step& s : steps) {
    for_each_vertex(x.size(), [&](std::size_t v) {
      Displacement change = umbrella(near, x, v);
      if (source) change += (*source)[v];
      before[v] = x[v] + s.momentum * (x[v] - before[v]) + s.factor * strength[v] * change;
    });
    std::swap(x, before);
  }
}

/// Of a piece: signed volume, the area that moves, and the sums that make the mean length of an edge.
struct Measure {
  double volume = 0.0, area = 0.0, edges = 0.0, n_faces = 0.0;
  double edge() const { return edges / std::max(1.0, n_faces); }
  void add(const Measure& other) {
    volume += other.volume;
    area += other.area;
    edges += other.edges;
    n_faces += other.n_faces;
  }
};

Measure measure_face(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t, std::span<const float> strength,
                     const Vec3& origin) {
  const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin, c = mesh.vertices[t[2]] - origin;
  return {a.dot(b.cross(c)) / 6.0,
          (b - a).cross(c - a).norm() / 6.0 * (strength[t[0]] + strength[t[1]] + strength[t[2]]),
          ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0, 1.0};
}

/// Of each piece that is not `done`. Faces are summed in blocks of fixed size, and these in order: the same bytes on
/// any number of threads.
std::vector<Measure> measure(const TriangleMesh& mesh, const MeshComponents& pieces, std::span<const float> strength,
                             const std::vector<std::uint8_t>& done) {
  struct Part {
    std::uint32_t piece;
    Measure measure;
  };
  const Vec3 origin = mesh.vertices.front();
  std::vector<std::vector<Part>> parts((mesh.triangles.size() + grain - 1) / grain);
  parallel_blocks(
      parts.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block)
          for (std::size_t f = block * grain; f < std::min((block + 1) * grain, mesh.triangles.size()); ++f) {
            const auto& t = mesh.triangles[f];
            const std::uint32_t piece = pieces.of_vertex[t[0]];
            if (done[piece] != 0) continue;
            if (parts[block].empty() || parts[block].back().piece != piece) parts[block].push_back({piece, {}});
            parts[block].back().measure.add(measure_face(mesh, t, strength, origin));
          }
      },
      1);
  std::vector<Measure> out(pieces.count);
  for (const auto& block : parts)
    for (const Part& part : block) out[part.piece].add(part.measure);
  return out;
}

Vec3f normal_at(const TriangleMesh& mesh, const VertexNeighbours& near, std::size_t v) {
  const Vec3& a = mesh.vertices[v];
  Vec3f sum = Vec3f::Zero();
  for (std::uint32_t n = near.begin[v]; n < near.begin[v + 1]; ++n) {
    const Vec3f b = (mesh.vertices[near.neighbour[n]] - a).cast<float>(),
                c = (mesh.vertices[near.third[n]] - a).cast<float>();
    sum += b.cross(c);
  }
  return sum.normalized();
}

/// Takes back half the `displacement` of each piece that has lost more than half its volume by it, and again: bodies
/// that many passes would draw together to a point, or turn inside out. So much volume can be given back.
void limit_losses(TriangleMesh& mesh, const MeshComponents& pieces, std::span<const float> strength,
                  const std::vector<Measure>& before, const std::vector<Displacement>& displacement) {
  std::vector<std::uint8_t> done(pieces.count);
  for (double back = 0.5; back > 1e-3; back *= 0.5) {
    const std::vector<Measure> now = measure(mesh, pieces, strength, done);
    for (std::size_t p = 0; p < done.size(); ++p)
      if (done[p] == 0) done[p] = now[p].volume / before[p].volume > 0.5;
    if (std::find(done.begin(), done.end(), std::uint8_t{0}) == done.end()) return;
    for_each_vertex(mesh.vertices.size(), [&](std::size_t v) {
      if (done[pieces.of_vertex[v]] == 0) mesh.vertices[v] -= back * displacement[v].head<3>().cast<double>();
    });
  }
}

/// Newton's method on the shift of each piece along its normals: d volume / d shift = area. Small pieces that shrank a
/// lot overshoot at first, hence up to 8 rounds; large ones are done after one. A vertex moves by no more than half an
/// edge a round: where little of a piece is smoothed that little cannot give back all the volume, and must not fly off
/// in trying.
void restore_volumes(TriangleMesh& mesh, const MeshComponents& pieces, const VertexNeighbours& near,
                     std::span<const float> strength, const std::vector<Measure>& before) {
  std::vector<std::uint8_t> done(pieces.count);
  for (int round = 0; round < 8; ++round) {
    const std::vector<Measure> now = measure(mesh, pieces, strength, done);
    std::vector<double> shift(pieces.count, 0.0);
    for (std::size_t p = 0; p < shift.size(); ++p) {
      if (done[p] != 0) continue;
      const double missing = before[p].volume - now[p].volume;
      done[p] = std::abs(missing) <= 1e-5 * std::abs(before[p].volume) || now[p].area <= 0.0;
      if (done[p] != 0) continue;
      const double most = 0.5 * now[p].edge();  // strengths are 1 at most
      shift[p] = std::clamp(missing / now[p].area, -most, most);
    }
    if (std::find(done.begin(), done.end(), std::uint8_t{0}) == done.end()) return;
    std::vector<Vec3f> change(mesh.vertices.size());
    for_each_vertex(mesh.vertices.size(), [&](std::size_t v) {
      const double s = shift[pieces.of_vertex[v]] * strength[v];
      change[v] = s != 0.0 ? Vec3f(static_cast<float>(s) * normal_at(mesh, near, v)) : Vec3f::Zero();
    });
    for_each_vertex(mesh.vertices.size(), [&](std::size_t v) { mesh.vertices[v] += change[v].cast<double>(); });
  }
}

}  // namespace

void smooth_mesh(TriangleMesh& mesh, const VertexNeighbours& near, std::span<const float> strength, int passes) {
  CHECK_EQ(strength.size(), mesh.vertices.size());
  if (passes == 0 || mesh.vertices.empty()) return;
  const MeshComponents pieces = find_components(mesh);
  const std::vector<Measure> before = measure(mesh, pieces, strength, std::vector<std::uint8_t>(pieces.count));

  // Everything runs on displacements from the start, which are short: single precision then costs nothing at any
  // distance from the origin.
  const std::vector<Step> steps = smoothing_steps(passes);
  const std::size_t n = mesh.vertices.size();
  std::vector<Displacement> curvature(n), first(n, Displacement::Zero()), second(n);
  for_each_vertex(n, [&](std::size_t v) { curvature[v] << umbrella(near, mesh.vertices, v).cast<float>(), 0.0f; });
  apply_steps(first, &curvature, near, strength, steps);  // G x - x
  for_each_vertex(n, [&](std::size_t v) { second[v] = -first[v]; });
  apply_steps(second, nullptr, near, strength, steps);  // G (x - G x)
  for_each_vertex(n, [&](std::size_t v) {
    first[v] += second[v];
    mesh.vertices[v] += first[v].head<3>().cast<double>();
  });
  limit_losses(mesh, pieces, strength, before, first);
  restore_volumes(mesh, pieces, near, strength, before);
}

std::vector<Vec3f> compute_vertex_normals(const TriangleMesh& mesh, const VertexNeighbours& near) {
  std::vector<Vec3f> normals(mesh.vertices.size());
  for_each_vertex(normals.size(), [&](std::size_t v) { normals[v] = normal_at(mesh, near, v); });
  return normals;
}

std::vector<Vec3f> compute_vertex_normals(const TriangleMesh& mesh) {
  return compute_vertex_normals(mesh, find_vertex_neighbours(mesh));
}

}  // namespace smelt
