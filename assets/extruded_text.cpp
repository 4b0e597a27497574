#include "assets/extruded_text.h"

#include "core/error.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace smelt {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Contour = CGAL::Polygon_2<Kernel>;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

/// Gathers contours while FreeType walks along an outline.
struct Pen {
  std::vector<Contour> contours;
  Point at;
  Point offset;     ///< of the letter [em]
  double em = 1.0;  ///< in font units
  double chord = 0.0;

  Point place(const FT_Vector& v) const {
    return {offset.x() + static_cast<double>(v.x) / em, offset.y() + static_cast<double>(v.y) / em};
  }

  /// A Bezier curve of second degree; FreeType ends each contour where it began, and that point is there already.
  void curve_to(const Point& control, const Point& to) {
    const double length =
        std::sqrt(CGAL::squared_distance(at, control)) + std::sqrt(CGAL::squared_distance(control, to));
    const int n = std::max(1, static_cast<int>(std::ceil(length / chord)));
    for (int k = 1; k <= n; ++k) {
      const double t = static_cast<double>(k) / n, u = 1.0 - t;
      line_to({u * u * at.x() + 2.0 * u * t * control.x() + t * t * to.x(),
               u * u * at.y() + 2.0 * u * t * control.y() + t * t * to.y()});
    }
    at = to;
  }

  void line_to(const Point& to) {
    Contour& contour = contours.back();
    if (to != contour[0] && to != contour[contour.size() - 1]) contour.push_back(to);
  }
};

Pen& pen_of(void* user) {
  return *static_cast<Pen*>(user);
}

int move_pen(const FT_Vector* to, void* user) {
  Pen& pen = pen_of(user);
  pen.at = pen.place(*to);
  pen.contours.emplace_back().push_back(pen.at);
  return 0;
}

int draw_line(const FT_Vector* to, void* user) {
  Pen& pen = pen_of(user);
  pen.at = pen.place(*to);
  pen.line_to(pen.at);
  return 0;
}

int draw_conic(const FT_Vector* control, const FT_Vector* to, void* user) {
  Pen& pen = pen_of(user);
  pen.curve_to(pen.place(*control), pen.place(*to));
  return 0;
}

int refuse_cubic(const FT_Vector*, const FT_Vector*, const FT_Vector*, void*) {
  return 1;
}

std::vector<Contour> trace_text(const std::filesystem::path& font_file, const std::string& text, double chord) {
  FT_Library library = nullptr;
  if (FT_Init_FreeType(&library) != 0) fail("FreeType does not start");
  const std::unique_ptr<FT_LibraryRec_, decltype(&FT_Done_FreeType)> closes(library, FT_Done_FreeType);
  FT_Face font = nullptr;
  if (FT_New_Face(library, font_file.c_str(), 0, &font) != 0)
    fail("{}: FreeType cannot read this font", font_file.string());
  Pen pen;
  pen.em = font->units_per_EM;
  pen.chord = chord;
  FT_Outline_Funcs strokes{move_pen, draw_line, draw_conic, refuse_cubic, 0, 0};
  double advance = 0.0;
  for (const char letter : text) {
    const FT_UInt glyph = FT_Get_Char_Index(font, static_cast<FT_ULong>(letter));
    if (glyph == 0 || FT_Load_Glyph(font, glyph, FT_LOAD_NO_SCALE) != 0)
      fail("{}: has no letter '{}'", font_file.string(), letter);
    pen.offset = {advance, 0.0};
    if (FT_Outline_Decompose(&font->glyph->outline, &strokes, &pen) != 0)
      fail("{}: '{}' is not of straight lines and curves of second degree, as in TrueType fonts", font_file.string(),
           letter);
    advance += static_cast<double>(font->glyph->advance.x) / pen.em;
  }
  return std::move(pen.contours);
}

/// Even-odd rule: inside an outline and not inside one of its holes.
bool is_filled(const Triangulation::Face_handle& face, const std::vector<Contour>& contours) {
  const Point middle = CGAL::centroid(face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point());
  const auto around = std::count_if(contours.begin(), contours.end(),
                                    [&](const Contour& contour) { return contour.has_on_bounded_side(middle); });
  return around % 2 == 1;
}

}  // namespace

TriangleMesh make_extruded_text(const std::filesystem::path& font_file, const std::string& text, double depth,
                                double chord) {
  const std::vector<Contour> contours = trace_text(font_file, text, chord);
  if (contours.empty()) fail("\"{}\": nothing to see", text);
  Triangulation plane;
  for (const Contour& contour : contours)
    plane.insert_constraint(contour.vertices_begin(), contour.vertices_end(), true);

  // Each point of the plane is two vertices: 2 i in front, 2 i + 1 behind.
  TriangleMesh mesh;
  CGAL::Bbox_2 bounds;
  for (const Contour& contour : contours) bounds += contour.bbox();
  const double middle = 0.5 * (bounds.xmin() + bounds.xmax());
  for (const auto vertex : plane.finite_vertex_handles()) {
    vertex->info() = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const double z : {0.5 * depth, -0.5 * depth})
      mesh.vertices.emplace_back(vertex->point().x() - middle, vertex->point().y(), z);
  }
  for (const auto face : plane.finite_face_handles()) {
    if (!is_filled(face, contours)) continue;
    const std::uint32_t a = face->vertex(0)->info(), b = face->vertex(1)->info(), c = face->vertex(2)->info();
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({c + 1, b + 1, a + 1});
    // A side where the letter ends.
    for (int k = 0; k < 3; ++k) {
      const auto beyond = face->neighbor(k);
      if (!plane.is_infinite(beyond) && is_filled(beyond, contours)) continue;
      const std::uint32_t p = face->vertex(plane.ccw(k))->info(), q = face->vertex(plane.cw(k))->info();
      mesh.triangles.push_back({p, p + 1, q + 1});
      mesh.triangles.push_back({p, q + 1, q});
    }
  }
  return mesh;
}

}  // namespace smelt
