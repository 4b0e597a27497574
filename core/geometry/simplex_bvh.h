#pragma once
// Finds the triangles (3D), segments (2D) or points (1D) near a place or in the way of a sphere.

#include "core/geometry/swept_sphere.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace smelt {

/// One of many simplices, and how a point lies to it.
template <int Dim>
struct NearestSimplex {
  std::uint32_t simplex;
  double distance;  ///< [m]
  Vec<Dim> offset;  ///< from its closest point to the point [m]
};

/// What a moving sphere meets first of many simplices.
template <int Dim>
struct FirstContact {
  std::uint32_t simplex;
  SweepContact<Dim> contact;
};

/// A bounding volume hierarchy: each node tests eight boxes at once, the nearest is entered first. Boxes are floats,
/// widened by what rounding may take away; answers are those of trying every simplex in double precision. Queries may
/// run on many threads at once.
template <int Dim>
class SimplexBvh {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  explicit SimplexBvh(std::vector<Simplex<Dim>> simplices);

  const std::vector<Simplex<Dim>>& simplices() const { return simplices_; }

  /// Appends the indices, ascending, of all simplices no farther than `radius` [m] from `point`.
  void find_near(const Vec<Dim>& point, double radius, std::vector<std::uint32_t>& found) const;

  /// The simplex nearest to `point`, if it is nearer than `limit` [m]; of equals the first.
  std::optional<NearestSimplex<Dim>> nearest(const Vec<Dim>& point, double limit) const;

  /// From `point` to the nearest simplex [m]; `limit` [m] where none is nearer than that.
  double distance(const Vec<Dim>& point, double limit) const;

  /// The earliest contact (sweep_sphere()) with any simplex but `except`; of several at once that of the first.
  std::optional<FirstContact<Dim>> first_contact(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius,
                                                 std::uint32_t except = none) const;

  /// How many nodes, of eight boxes each, first_contact() looks into: what it costs, in a measure that no cache blurs.
  std::size_t count_visits(const Vec<Dim>& centre, const Vec<Dim>& displacement, double radius) const;

 private:
  static constexpr std::uint32_t width = 8;
  using Lanes = Eigen::Array<float, width, 1>;
  /// Boxes [m from middle_] of simplices or of further nodes, all of a kind; those of empty lanes are nowhere.
  struct Node {
    std::array<Lanes, Dim> lower, upper;
    std::uint32_t first = 0;  ///< of the nodes in its lanes, or which of the leaves it is
    bool leaf = false;
  };
  /// The simplices of a leaf node, and between what planes across their normals they lie.
  struct Leaf {
    std::array<std::uint32_t, width> simplex;
    std::array<Lanes, Dim> normal;
    Lanes lower, upper;
  };
  struct Builder;
  struct BallQuery;
  struct SweepQuery;
  template <typename Query, typename Meet>
  void visit(std::uint32_t node, Query& query, const Meet& meet) const;
  template <typename Query>
  void improve(std::optional<FirstContact<Dim>>& first, std::uint32_t k, Query& query, const Vec<Dim>& centre,
               const Vec<Dim>& displacement, double radius) const;

  std::vector<Simplex<Dim>> simplices_;
  std::vector<Node> nodes_;  ///< the root first
  std::vector<Leaf> leaves_;
  Vec<Dim> middle_ = Vec<Dim>::Zero();
  double extent_ = 0.0;  ///< longest side of the box of all [m]
};

}  // namespace smelt
