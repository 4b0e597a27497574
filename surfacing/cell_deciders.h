#pragma once
// What the signs of a cell's corners leave open, decided from the trilinear interpolant of its samples.

#include "surfacing/marching_cubes_table.h"

#include <array>
#include <cstdint>

namespace smelt {

/// Samples minus iso-value at the corners of a cell, numbered as in surfacing/marching_cubes_table.h; >= 0 is inside.
using CellSamples = std::array<float, 8>;

/// Asymptotic decider [Nielson & Hamann 1991]: bit f is set where ambiguous face f of `pattern` is joined through its
/// middle, that is where the saddle of its bilinear interpolant is at or above the iso-value. For inside samples p, q
/// on one diagonal and outside samples r, s on the other that is p q >= r s. The products of two floats are exact in
/// double, so both cells of a face decide alike, ties included (a saddle exactly at the iso-value joins).
std::uint8_t decide_faces(const CellSamples& sample, std::uint8_t ambiguous_faces);

/// The tube, if any, through which two loops of the cell are joined in the trilinear interpolant; null where all loops
/// are closed by discs. Method: sweep the cell along z; slices are bilinear, and the inside parts of a slice around
/// corners A and C of one diagonal merge where A C - B D, quadratic in z, rises through zero. Merging parts that belong
/// to different regions of the cell's boundary, or that cut apart outside regions which are different ones, make a
/// tube; all other merges are already seen on the faces. This is the critical-point form of the interior test, so the
/// failures of the published tables [Custodio et al. 2013] do not arise. A saddle exactly at the iso-value makes no
/// tube.
const CellTunnel* find_tunnel(const CellSamples& sample, const CellCase& cell);

}  // namespace smelt
