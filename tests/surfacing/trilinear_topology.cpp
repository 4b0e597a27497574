#include "tests/surfacing/trilinear_topology.h"

#include "core/geometry/vec.h"
#include "surfacing/marching_cubes.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace smelt::testing {
namespace {

/// f - iso at the corners of a cell; corner n at (n & 1, n >> 1 & 1, n >> 2 & 1).
using Cell = std::array<double, 8>;

/// A factor for every sample, so that no two are alike: ties, which are many and small, farther apart than others.
double distinct(std::size_t i, bool is_tie) {
  const double x = 0.6180339887498949 * static_cast<double>(i);
  return 1.0 + (is_tie ? 1e-4 : 1e-9) * (x - std::floor(x));
}

double value_at(const Cell& f, const Vec3& x) {
  double sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1.0;
    for (int a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? x[a] : 1.0 - x[a];
    sum += weight * f[c];
  }
  return sum;
}

Vec3 gradient_at(const Cell& f, const Vec3& x) {
  Vec3 g;
  for (int a = 0; a < 3; ++a) {
    Vec3 low = x, high = x;
    low[a] = 0.0;
    high[a] = 1.0;
    g[a] = value_at(f, high) - value_at(f, low);  // f is linear along an axis
  }
  return g;
}

/// A critical point of f inside the cell, and how many directions lead uphill from it: 1 or 2, as f has no second
/// derivative along an axis.
struct BodySaddle {
  Vec3 x;
  int n_up;
};

/// f = const + sum_a s_a X_a + h XYZ about the centre of its hyperbolas; grad f = 0 where h YZ = -s_x and so on.
std::vector<BodySaddle> find_body_saddles(const Cell& f) {
  const double h = f[7] - f[6] - f[5] - f[3] + f[4] + f[2] + f[1] - f[0];
  const double xy = f[3] - f[2] - f[1] + f[0], xz = f[5] - f[4] - f[1] + f[0], yz = f[6] - f[4] - f[2] + f[0];
  const Vec3 linear(f[1] - f[0], f[2] - f[0], f[4] - f[0]);
  std::vector<BodySaddle> saddles;
  const auto add = [&](const Vec3& x) {
    if ((x.array() <= 0.0).any() || (x.array() >= 1.0).any() || !x.allFinite()) return;
    // Hessian: zero diagonal; determinant 2 f_xy f_xz f_yz, positive with one uphill direction.
    const double det = (xy + h * x[2]) * (xz + h * x[1]) * (yz + h * x[0]);
    if (det != 0.0) saddles.push_back({x, det > 0.0 ? 1 : 2});
  };
  const Vec3 centre(-yz / h, -xz / h, -xy / h);
  const Vec3 s = linear - Vec3(xy * xz, xy * yz, xz * yz) / h;
  const double square = -s[0] * s[1] * s[2] / h;  // of h XYZ
  if (!(square > 0.0)) return saddles;
  for (const double product : {std::sqrt(square), -std::sqrt(square)})  // h XYZ
    add(centre - product * Vec3(1.0 / s[0], 1.0 / s[1], 1.0 / s[2]));
  return saddles;
}

/// The corner that the steepest way up leads to, within the cell.
int climb(const Cell& f, Vec3 x) {
  constexpr double stride = 0.01;
  for (int step = 0; step < 4000; ++step) {
    Vec3 g = gradient_at(f, x);
    for (int a = 0; a < 3; ++a)
      if ((x[a] <= 0.0 && g[a] < 0.0) || (x[a] >= 1.0 && g[a] > 0.0)) g[a] = 0.0;
    if (g.norm() < 1e-12) break;
    x = (x + stride * g.normalized()).cwiseMax(0.0).cwiseMin(1.0);
  }
  int corner = 0;
  for (int a = 0; a < 3; ++a) corner |= (x[a] > 0.5 ? 1 : 0) << a;
  return corner;
}

Cell negative(Cell f) {
  for (double& v : f) v = -v;
  return f;
}

/// The uphill direction at a saddle with one: the eigenvector of the Hessian's positive eigenvalue.
Vec3 uphill_direction(const Cell& f, const Vec3& x) {
  Mat3 hessian = Mat3::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      if (a == b) continue;
      Vec3 low = x, high = x;
      low[b] = 0.0;
      high[b] = 1.0;
      hessian(a, b) = gradient_at(f, high)[a] - gradient_at(f, low)[a];
    }
  return Eigen::SelfAdjointEigenSolver<Mat3>(hessian).eigenvectors().col(2);
}

class Parts {
 public:
  explicit Parts(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }
  int count() {
    int n = 0;
    for (std::size_t i = 0; i < parent_.size(); ++i) n += root(i) == i;
    return n;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// The padded grid as a set of vertices, edges, faces and cells.
class Complex {
 public:
  Complex(const DenseGrid& grid, float iso) {
    for (int a = 0; a < 3; ++a) n_[a] = grid.n[a] + 2;
    value_.assign(static_cast<std::size_t>(n_[0]) * n_[1] * n_[2], -static_cast<double>(iso));
    for (int k = 0; k < grid.n[2]; ++k)
      for (int j = 0; j < grid.n[1]; ++j)
        for (int i = 0; i < grid.n[0]; ++i)
          value_[index({i + 1, j + 1, k + 1})] = grid.at(i, j, k) == iso
                                                     ? static_cast<double>(tie_lift * iso)
                                                     : static_cast<double>(grid.at(i, j, k)) - static_cast<double>(iso);
    for (std::size_t i = 0; i < value_.size(); ++i)
      value_[i] *= distinct(i, value_[i] == static_cast<double>(tie_lift * iso));
  }

  SurfaceTopology topology() {
    Parts parts(value_.size());
    int euler = 0;
    for (int k = 0; k < n_[2]; ++k)
      for (int j = 0; j < n_[1]; ++j)
        for (int i = 0; i < n_[0]; ++i) {
          const Lattice at{i, j, k};
          euler += inside(at);
          for (int a = 0; a < 3; ++a) euler += visit_edge(parts, at, a) + visit_face(parts, at, a);
          euler += visit_cell(parts, at);
        }
    return {2 * euler, parts.count() - 1};
  }

 private:
  std::size_t index(const Lattice& p) const { return static_cast<std::size_t>(p[0] + n_[0] * (p[1] + n_[1] * p[2])); }
  double value(const Lattice& p) const { return value_[index(p)]; }
  bool inside(const Lattice& p) const { return value(p) >= 0.0; }
  static Lattice stepped(Lattice p, int axis) {
    ++p[axis];
    return p;
  }
  bool has_room(const Lattice& p, int axis) const { return p[axis] + 1 < n_[axis]; }

  /// An open edge has the compact Euler characteristic -1 where all of it is inside, else 0.
  int visit_edge(Parts& parts, const Lattice& p, int axis) const {
    if (!has_room(p, axis)) return 0;
    const Lattice q = stepped(p, axis);
    if (inside(p) == inside(q)) parts.join(index(p), index(q));
    return inside(p) && inside(q) ? -1 : 0;
  }

  /// The face across `axis`: that of the closed face (local maxima at corners, a saddle takes one off) less that of its
  /// edges and corners.
  int visit_face(Parts& parts, const Lattice& p, int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (!has_room(p, u) || !has_room(p, v)) return 0;
    const std::array<Lattice, 4> corner = {p, stepped(p, u), stepped(stepped(p, u), v),
                                           stepped(p, v)};  // around the face
    std::array<double, 4> f;
    int euler = 0;
    for (int i = 0; i < 4; ++i) f[i] = value(corner[i]);
    for (int i = 0; i < 4; ++i) {
      const double before = f[(i + 3) % 4], after = f[(i + 1) % 4];
      euler += f[i] >= 0.0 && f[i] > before && f[i] > after;  // local maximum of the face
      euler -= f[i] >= 0.0;                                   // the corner
      euler += f[i] >= 0.0 && after >= 0.0;                   // the edge
    }
    // Bilinear: a saddle inside the face where both its diagonals are on one side each.
    if (!has_saddle(f)) return euler;
    const bool up_02 = f[0] > f[1], saddle_inside = saddle_value(f) >= 0.0;
    if (saddle_inside) --euler;
    const int first = up_02 == saddle_inside ? 0 : 1;  // the diagonal that the saddle joins
    const std::size_t a = index(corner[first]), b = index(corner[first + 2]);
    if ((value_[a] >= 0.0) == saddle_inside && (value_[b] >= 0.0) == saddle_inside) parts.join(a, b);
    return euler;
  }

  /// As for a face; a saddle of a face counts where f falls from it into the cell.
  int visit_cell(Parts& parts, const Lattice& p) const {
    for (int a = 0; a < 3; ++a)
      if (!has_room(p, a)) return 0;
    Cell f;
    std::array<std::size_t, 8> at;
    for (int c = 0; c < 8; ++c) {
      at[c] = index({p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2 & 1)});
      f[c] = value_[at[c]];
    }
    int euler = -boundary_euler(f);
    for (int c = 0; c < 8; ++c) {
      if (f[c] < 0.0) continue;
      bool highest = true;
      for (int a = 0; a < 3; ++a) highest = highest && f[c] > f[c ^ 1 << a];
      euler += highest;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) euler -= falling_saddle(f, axis, side);
    for (const BodySaddle& s : find_body_saddles(f)) {
      const bool is_inside = value_at(f, s.x) >= 0.0;
      if (is_inside) euler += s.n_up == 1 ? -1 : 1;
      // One way up joins parts inside, one way down parts outside.
      if ((s.n_up == 1) != is_inside) continue;
      const Cell up = is_inside ? f : negative(f);
      const Vec3 way = uphill_direction(up, s.x);
      const int a = climb(up, s.x + 1e-3 * way), b = climb(up, s.x - 1e-3 * way);
      if ((f[a] >= 0.0) == is_inside && (f[b] >= 0.0) == is_inside) parts.join(at[a], at[b]);
    }
    return euler;
  }

  /// Euler characteristic of the inside part of the cell's boundary, a sphere: corners, edges and faces added up.
  static int boundary_euler(const Cell& f) {
    int euler = 0;
    for (int c = 0; c < 8; ++c) {
      euler += f[c] >= 0.0;
      for (int a = 0; a < 3; ++a)
        if ((c >> a & 1) == 0) euler -= f[c] >= 0.0 && f[c | 1 << a] >= 0.0;
    }
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const std::array<double, 4> g = face_values(f, axis, side);
        for (int i = 0; i < 4; ++i) {
          euler += g[i] >= 0.0 && g[i] > g[(i + 3) % 4] && g[i] > g[(i + 1) % 4];
          euler -= g[i] >= 0.0;
          euler += g[i] >= 0.0 && g[(i + 1) % 4] >= 0.0;
        }
        euler -= has_saddle(g) && saddle_value(g) >= 0.0;
      }
    return euler;
  }

  static std::array<int, 4> face_corners_around(int axis, int side) {
    const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
    return {base, base | u, base | u | v, base | v};
  }
  static std::array<double, 4> face_values(const Cell& f, int axis, int side) {
    const auto c = face_corners_around(axis, side);
    return {f[c[0]], f[c[1]], f[c[2]], f[c[3]]};
  }
  static bool has_saddle(const std::array<double, 4>& g) {
    return std::min(g[0], g[2]) > std::max(g[1], g[3]) || std::min(g[1], g[3]) > std::max(g[0], g[2]);
  }
  static double saddle_value(const std::array<double, 4>& g) {
    return (g[0] * g[2] - g[1] * g[3]) / (g[0] - g[1] + g[2] - g[3]);
  }

  /// Whether a face has a saddle that is inside, from which f falls into the cell.
  static bool falling_saddle(const Cell& f, int axis, int side) {
    const auto near = face_values(f, axis, side), far = face_values(f, axis, 1 - side);
    if (!has_saddle(near) || saddle_value(near) < 0.0) return false;
    const double d = near[0] - near[1] + near[2] - near[3];
    const double u = (near[0] - near[3]) / d, v = (near[0] - near[1]) / d;  // where the saddle is
    const double opposite = far[0] * (1 - u) * (1 - v) + far[1] * u * (1 - v) + far[2] * u * v + far[3] * (1 - u) * v;
    return opposite < saddle_value(near);
  }

  Lattice n_{};
  std::vector<double> value_;
};

}  // namespace

SurfaceTopology find_topology(const DenseGrid& grid, float iso) {
  return Complex(grid, iso).topology();
}

}  // namespace smelt::testing
