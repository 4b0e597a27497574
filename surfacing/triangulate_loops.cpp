#include "surfacing/triangulate_loops.h"

#include "core/error.h"
#include "core/geometry/vec.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace smelt {

namespace {

using Id = std::uint8_t;
constexpr double forbidden = std::numeric_limits<double>::infinity();

Vec3 corner_position(int corner) {
  return Vec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
}

Vec3 edge_middle(int edge) {
  const auto [low, high] = edge_corners(edge);
  return 0.5 * (corner_position(low) + corner_position(high));
}

Vec3 position(const CellSurface& surface, Id id) {
  if (id < 12) return edge_middle(id);
  Vec3 sum = Vec3::Zero();
  const auto& mean_of = surface.inner[id - 12u];
  for (const Id edge : mean_of) sum += edge_middle(edge);
  return sum / static_cast<double>(mean_of.size());
}

/// Squared length of an edge drawn across the cell; infinite between two edge vertices on one face.
double drawing_cost(const CellSurface& surface, Id a, Id b) {
  const Vec3 p = position(surface, a), q = position(surface, b);
  if (a < 12 && b < 12)
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] == q[axis] && p[axis] != 0.5) return forbidden;
  return (p - q).squaredNorm();
}

/// The triangles of the best triangulation of loop[i..j], from the table of best splits.
void collect(CellSurface& surface, std::span<const Id> loop, const std::array<std::array<int, 12>, 12>& split, int i,
             int j) {
  if (j - i < 2) return;
  const int m = split[i][j];
  surface.triangles.push_back({loop[i], loop[m], loop[j]});
  collect(surface, loop, split, i, m);
  collect(surface, loop, split, m, j);
}

Id add_inner(CellSurface& surface, std::vector<Id> mean_of) {
  surface.inner.push_back(std::move(mean_of));
  return static_cast<Id>(12 + surface.inner.size() - 1);
}

/// Which pairs (i, j) a band between rings of n and m vertices walks through, as steps: true along `a`, false along
/// `b`.
struct BandPath {
  double cost = forbidden;
  std::vector<bool> along_a;
};

/// The cheapest walk from (0, 0) to (n, m). Its first step goes along `a` and its last along `b`: any band has such a
/// corner to start from. Then only a walk through (n, 0) is a fan of one whole ring about one vertex of the other,
/// which would draw its first edge twice; that node is closed.
template <typename Cost>
BandPath cheapest_walk(std::size_t n, std::size_t m, Cost&& cost) {
  const auto node = [&](std::size_t i, std::size_t j) { return i * (m + 1) + j; };
  std::vector<double> total((n + 1) * (m + 1), forbidden);
  std::vector<bool> came_along_a((n + 1) * (m + 1));
  total[0] = 0.0;
  for (std::size_t i = 1; i <= n; ++i)
    for (std::size_t j = 0; j <= m; ++j) {
      if (i == n && j == 0) continue;
      const double step_a = i == n && j == m ? forbidden : total[node(i - 1, j)];
      const double step_b = j > 0 ? total[node(i, j - 1)] : forbidden;
      came_along_a[node(i, j)] = step_a <= step_b;
      total[node(i, j)] = std::min(step_a, step_b) + cost(i, j);
    }
  BandPath path{total[node(n, m)], {}};
  if (path.cost == forbidden) return path;
  for (std::size_t i = n, j = m; i + j > 0;) {
    path.along_a.push_back(came_along_a[node(i, j)]);
    path.along_a.back() ? --i : --j;
  }
  std::reverse(path.along_a.begin(), path.along_a.end());
  return path;
}

/// Triangles between two closed rings that run in opposite senses around a tube: the cheapest walk over the pairs (i,
/// j), i steps taken along `a`, j steps taken backwards along `b`. False, and nothing added, where all walks draw a
/// forbidden edge.
bool add_band(CellSurface& surface, std::span<const Id> a, std::span<const Id> b) {
  const std::size_t n = a.size(), m = b.size();
  std::vector<double> cost(n * m);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) cost[i * m + j] = drawing_cost(surface, a[i], b[j]);
  BandPath best;
  std::size_t first_a = 0, first_b = 0;
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t t = 0; t < m; ++t) {
      BandPath path = cheapest_walk(
          n, m, [&](std::size_t i, std::size_t j) { return cost[(s + i) % n * m + (t + 2 * m - j) % m]; });
      if (path.cost >= best.cost) continue;
      best = std::move(path);
      first_a = s;
      first_b = t;
    }
  std::size_t i = first_a, j = first_b + m;
  for (const bool along_a : best.along_a) {
    if (along_a) {
      surface.triangles.push_back({a[i % n], a[(i + 1) % n], b[j % m]});
      ++i;
    } else {
      surface.triangles.push_back({b[(j - 1) % m], b[j % m], a[i % n]});
      --j;
    }
  }
  return best.cost < forbidden;
}

}  // namespace

void add_disc(CellSurface& surface, std::span<const Id> loop) {
  const int n = static_cast<int>(loop.size());
  CHECK_LE(n, 12);
  std::array<std::array<double, 12>, 12> total{};
  std::array<std::array<int, 12>, 12> split{};
  for (int length = 2; length < n; ++length)
    for (int i = 0; i + length < n; ++i) {
      const int j = i + length;
      total[i][j] = forbidden;
      for (int m = i + 1; m < j; ++m)
        if (const double cost = total[i][m] + total[m][j]; cost < total[i][j]) {
          total[i][j] = cost;
          split[i][j] = m;
        }
      if (length < n - 1) total[i][j] += drawing_cost(surface, loop[i], loop[j]);
    }
  if (total[0][n - 1] < forbidden) return collect(surface, loop, split, 0, n - 1);

  const Id centre = add_inner(surface, {loop.begin(), loop.end()});
  for (int i = 0; i < n; ++i) surface.triangles.push_back({loop[i], loop[(i + 1) % n], centre});
}

void add_tube(CellSurface& surface, std::span<const Id> a, std::span<const Id> b) {
  if (add_band(surface, a, b)) return;

  // A ring of inner vertices half-way, then a band on either side of it: no edge of those lies in a face.
  const std::size_t n = a.size();
  std::vector<Id> ring;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = edge_middle(a[i]);
    const Id nearest = *std::min_element(b.begin(), b.end(), [&](Id p, Id q) {
      return (edge_middle(p) - x).squaredNorm() < (edge_middle(q) - x).squaredNorm();
    });
    ring.push_back(add_inner(surface, {a[(i + n - 1) % n], a[i], a[i], a[(i + 1) % n], nearest}));
  }
  const std::vector<Id> reversed(ring.rbegin(), ring.rend());
  CHECK(add_band(surface, a, reversed));
  CHECK(add_band(surface, ring, b));
}

}  // namespace smelt
