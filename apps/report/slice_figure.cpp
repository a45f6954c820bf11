#include "apps/report/slice_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include "apps/report/bit_outline.h"
#include "apps/report/label_place.h"
#include "apps/report/png.h"
#include "apps/report/text.h"
#include "core/base/error.h"

namespace spinaltap {
namespace {

using Point = Eigen::Vector2d;

// Okabe & Ito's colours for all kinds of colour vision; bright ones, since CT slices are dark.
constexpr std::string_view kBitColour = "#56B4E9";
constexpr std::string_view kEntryColour = "#F0E442";
constexpr std::string_view kTargetColour = "#FF8A3D";
constexpr double kLabelSize = 14.0;

/// Writes SVG in drawing units, which are pixels times a scale.
class SliceDrawing {
 public:
  SliceDrawing(const CtSlice& slice, const SliceFigureOptions& options)
      : frame_(slice.frame),
        units_per_pixel_(options.width_units / slice.frame.width),
        size_(options.width_units, units_per_pixel_ * slice.frame.height),
        placer_({Point::Zero(), size_}) {}

  Point size() const { return size_; }
  std::string take() { return std::move(svg_); }

  /// Pixel centres sit on integers: the picture begins half a pixel before (0, 0).
  Point to_units(const Point& pixel) const { return units_per_pixel_ * (pixel + Point(0.5, 0.5)); }

  void add_picture(const Image& image) {
    svg_ += "<image width=\"" + svg_number(size_.x()) + "\" height=\"" + svg_number(size_.y()) +
            "\" preserveAspectRatio=\"none\" href=\"data:image/png;base64," + base64(encode_png(image)) + "\"/>\n";
  }

  void add_bit(const DrillPath& path) {
    const Pose pose{path.target_mm, path.direction()};
    for (const PixelPolygon& polygon : bit_projection(frame_, path.bit, pose)) {
      const PixelPolygon projection = in_units(polygon);
      if (!holds_path(path)) {
        add_polygon(projection, "fill-opacity=\"0.10\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"");
      }
      placer_.avoid_shape(projection);
    }
    for (const PixelPolygon& section : bit_section(frame_, path.bit, pose)) {
      add_polygon(in_units(section), "fill-opacity=\"0.28\" stroke-width=\"1.8\"");
    }
  }

  void add_axis(const DrillPath& path) {
    const std::string line =
        "<path d=\"M" + point(in_units(path.entry_mm)) + "L" + point(in_units(path.target_mm)) + "\" ";
    svg_ += line + "stroke=\"#000\" stroke-opacity=\"0.35\" stroke-width=\"2.6\"/>" + line +
            "stroke=\"#fff\" stroke-width=\"1.2\" stroke-dasharray=\"9 3 2 3\"/>\n";
  }

  /// The markers first, then their labels, which keep clear of both.
  void add_ends(const DrillPath& path) {
    const Point entry = in_units(path.entry_mm);
    const Point target = in_units(path.target_mm);
    svg_ += "<circle cx=\"" + svg_number(entry.x()) + "\" cy=\"" + svg_number(entry.y()) +
            "\" r=\"5\" fill=\"none\" stroke=\"#000\" stroke-width=\"4\" stroke-opacity=\"0.5\"/><circle cx=\"" +
            svg_number(entry.x()) + "\" cy=\"" + svg_number(entry.y()) + "\" r=\"5\" fill=\"none\" stroke=\"" +
            std::string(kEntryColour) + "\" stroke-width=\"2\"/>\n";
    const std::string cross = "M" + point(target + Point(-5, -5)) + "L" + point(target + Point(5, 5)) + "M" +
                              point(target + Point(-5, 5)) + "L" + point(target + Point(5, -5));
    svg_ += "<path d=\"" + cross + "\" stroke=\"#000\" stroke-width=\"4.5\" stroke-opacity=\"0.5\"/><path d=\"" +
            cross + "\" stroke=\"" + std::string(kTargetColour) + "\" stroke-width=\"2.4\"/>\n";
    for (const Point& marker : {entry, target}) placer_.avoid({marker - Point(8, 8), marker + Point(8, 8)});
    add_label("Entry", entry, kEntryColour);
    add_label("Target", target, kTargetColour);
  }

  void add_letters() {
    const Point middle = 0.5 * size_;
    const std::array<std::pair<Vec3, Point>, 4> sides{{{-frame_.right, {6.0, middle.y()}},
                                                       {frame_.right, {size_.x() - 6.0, middle.y()}},
                                                       {-frame_.down, {middle.x(), 14.0}},
                                                       {frame_.down, {middle.x(), size_.y() - 14.0}}}};
    constexpr std::array<std::string_view, 4> kAnchors{"start", "end", "middle", "middle"};
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const auto& [direction, place] = sides[i];
      add_text(orientation_letters(direction), place, kAnchors[i], "#fff", "font-size=\"16\" font-weight=\"700\"");
      placer_.avoid({place - Point(20, 12), place + Point(20, 12)});
    }
  }

  void add_scale_bar(double length_mm) {
    const double length = length_mm / frame_.pixel_mm * units_per_pixel_;
    const Point left(14.0, size_.y() - 14.0);
    const std::string bar =
        "M" + point(left + Point(0, -4)) + "v8M" + point(left) + "h" + svg_number(length) + "m0 -4v8";
    svg_ += "<path d=\"" + bar +
            "\" fill=\"none\" stroke=\"#000\" stroke-opacity=\"0.5\" stroke-width=\"5\"/><path d=\"" + bar +
            "\" fill=\"none\" stroke=\"#fff\" stroke-width=\"2\"/>\n";
    add_text(svg_number(length_mm) + " mm", left + Point(0.5 * length, -12), "middle", "#fff");
    placer_.avoid({left + Point(-4, -24), left + Point(length + 4, 6)});
  }

 private:
  static std::string point(const Point& p) { return svg_number(p.x()) + " " + svg_number(p.y()); }

  Point in_units(const Vec3& p_patient) const { return to_units(frame_.to_pixel(p_patient).head<2>()); }
  PixelPolygon in_units(PixelPolygon polygon) const {
    for (Point& p : polygon) p = to_units(p);
    return polygon;
  }

  bool holds_path(const DrillPath& path) const {
    const double away_pixels =
        std::max(std::abs(frame_.to_pixel(path.entry_mm).z()), std::abs(frame_.to_pixel(path.target_mm).z()));
    return away_pixels * frame_.pixel_mm < 0.01;
  }

  /// Over a dark line, for bone is as bright as the bit's colour.
  void add_polygon(const PixelPolygon& polygon, const std::string& style) {
    std::string points = "<polygon points=\"";
    for (const Point& p : polygon) points += (&p == &polygon.front() ? "" : " ") + point(p);
    points += "\" stroke-linejoin=\"round\" ";
    svg_ += points + "fill=\"none\" stroke=\"#000\" stroke-opacity=\"0.35\" stroke-width=\"3\"/>" + points + "fill=\"" +
            std::string(kBitColour) + "\" stroke=\"" + std::string(kBitColour) + "\" " + style + "/>\n";
  }

  void add_text(const std::string& text, const Point& place, std::string_view anchor, std::string_view colour,
                const std::string& style = "font-size=\"14\" font-weight=\"600\"") {
    svg_ += "<text x=\"" + svg_number(place.x()) + "\" y=\"" + svg_number(place.y()) +
            "\" dominant-baseline=\"central\" text-anchor=\"" + std::string(anchor) + "\" fill=\"" +
            std::string(colour) +
            "\" stroke=\"#000\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\" " + style + ">" +
            escape_html(text) + "</text>\n";
  }

  void add_label(const std::string& text, const Point& anchor, std::string_view colour) {
    const LabelPlacer::Rectangle place = placer_.place(anchor, {text_width(text, kLabelSize) + 4.0, kLabelSize + 4.0});
    // A thin line from the label's edge to the marker's rim, where they are apart.
    const Point near = anchor.cwiseMax(place.min()).cwiseMin(place.max());
    const Point way = near - anchor;
    if (way.norm() > 12.0) {
      svg_ += "<path d=\"M" + point(near) + "L" + point(anchor + 7.0 * way.normalized()) + "\" stroke=\"" +
              std::string(colour) + "\" stroke-width=\"1\"/>\n";
    }
    add_text(text, place.center(), "middle", colour);
  }

  const SliceFrame& frame_;
  double units_per_pixel_;
  Point size_;
  LabelPlacer placer_;
  std::string svg_;
};

/// The bone and the path with some room around.
Box3 shown_box(const DrillPath& path, Box3 box) {
  const double room_mm = box.isEmpty() ? 25.0 : 5.0;
  box.extend(path.entry_mm);
  box.extend(path.target_mm);
  return Box3(box.min() - Vec3::Constant(room_mm), box.max() + Vec3::Constant(room_mm));
}

}  // namespace

std::string slice_svg(const CtSlice& slice, const DrillPath& path, const std::string& description,
                      const SliceFigureOptions& options) {
  if (slice.frame.width != slice.image.width || slice.frame.height != slice.image.height) {
    fail("slice figure: expected a picture of ", slice.frame.width, " x ", slice.frame.height, " pixels, found ",
         slice.image.width, " x ", slice.image.height);
  }
  SliceDrawing drawing(slice, options);
  drawing.add_picture(slice.image);
  drawing.add_bit(path);
  drawing.add_axis(path);
  drawing.add_letters();
  drawing.add_scale_bar(options.scale_bar_mm);
  drawing.add_ends(path);
  return "<svg class=\"slice\" role=\"img\" aria-label=\"" + escape_html(description) + "\" viewBox=\"0 0 " +
         svg_number(drawing.size().x()) + " " + svg_number(drawing.size().y()) + "\">\n" + drawing.take() + "</svg>\n";
}

std::string plane_caption(Plane plane, const SliceFrame& frame) {
  switch (plane) {
    case Plane::kAxial:
      return "Axial, z = " + readable_number(frame.origin_mm.z(), 1) + " mm";
    case Plane::kCoronal:
      return "Coronal, y = " + readable_number(frame.origin_mm.y(), 1) + " mm";
    case Plane::kSagittal:
      return "Sagittal, x = " + readable_number(frame.origin_mm.x(), 1) + " mm";
  }
  fail("unknown plane");
}

std::string path_caption(const SliceFrame& frame) {
  const double cosine = std::min(1.0, std::abs(frame.into().z()));
  return "Along the path, " + readable_number(std::acos(cosine) * 180.0 / std::numbers::pi, 1) + "° from axial";
}

std::vector<ReportDrawing> path_slices(const CtVolume& ct, const DrillPath& path, const Box3& bone_bounds_mm) {
  constexpr double kMaxPixels = 1200.0;  // along the box's longest side: coarser pixels beyond 240 mm
  struct View {
    SliceFrame frame;
    std::string caption;
  };
  const Box3 box = shown_box(path, bone_bounds_mm);
  const double pixel_mm = std::max(0.2, box.sizes().maxCoeff() / kMaxPixels);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  const auto standard = [&](Plane plane) {
    const SliceFrame frame = plane_frame(plane, middle_mm, box, pixel_mm);
    return View{frame, plane_caption(plane, frame)};
  };
  const SliceFrame along = path_frame(path, box, pixel_mm);
  std::array<View, 4> views{View{along, path_caption(along)}, standard(Plane::kAxial), standard(Plane::kSagittal),
                            standard(Plane::kCoronal)};
  int width = 0;
  for (const View& view : views) width = std::max(width, view.frame.width);
  std::vector<ReportDrawing> drawings;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const SliceFrame frame = grown_to(views[i].frame, width, views[i ^ 1U].frame.height);
    drawings.push_back({slice_svg(ct_slice(ct, frame), path, views[i].caption), views[i].caption});
  }
  return drawings;
}

}  // namespace spinaltap
