#include "apps/report/slice_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "apps/report/bit_outline.h"
#include "apps/report/label_place.h"
#include "apps/report/png.h"
#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/tool/bit_profile.h"
#include "core/tool/bit_ray.h"
#include "core/tool/path_curve.h"

namespace spinaltap {
namespace {

using Point = Eigen::Vector2d;

// Okabe & Ito's colours for all kinds of colour vision; bright ones, since CT slices are dark.
constexpr std::string_view kBitColour = "#56B4E9";
constexpr std::string_view kEntryColour = "#F0E442";
constexpr std::string_view kTargetColour = "#FF8A3D";
constexpr std::string_view kBoneColour = "#FFD84D";
constexpr std::string_view kCanalColour = "#FF66B8";
constexpr double kLabelSize = 14.0;

struct PlacedPart {
  ToolPart part;
  Pose pose;
};

Pose at_target(const DrillPath& path) {
  const PathCurve curve(path);
  return {path.target_mm, curve.direction_at(curve.length_mm())};
}

/// The thread or shaft first, then the head.
std::vector<PlacedPart> parts_of(const DrillPath& path) {
  std::vector<PlacedPart> parts;
  const Pose pose = at_target(path);
  for (ToolPart& part : tool_parts(path.screw ? path.screw->outline() : path.bit))
    parts.push_back({std::move(part), pose});
  if (const std::optional<BodyBehind> head = head_of(path)) {
    for (ToolPart& part : tool_parts(head->outline)) parts.push_back({std::move(part), head->pose});
  }
  return parts;
}

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

  void add_outline(const OutlinedBone& bone) {
    for (const bool is_canal : {false, true}) {
      std::string data;
      for (const OutlineRun& run : bone_outline(bone, frame_)) {
        if (run.is_canal != is_canal) continue;
        for (std::size_t n = 0; n < run.points.size(); ++n) {
          data += (n == 0 ? "M" : "L") + point(to_units(run.points[n]));
        }
        if (run.is_closed) data += "Z";
      }
      if (data.empty()) continue;
      svg_ += "<path class=\"" + std::string(is_canal ? "canal" : "bone") + "\" d=\"" + data +
              "\" fill=\"none\" stroke-linejoin=\"round\" stroke=\"" +
              std::string(is_canal ? kCanalColour : kBoneColour) + "\" stroke-width=\"" + (is_canal ? "1.8" : "1") +
              "\"/>\n";
    }
  }

  void add_tool(const DrillPath& path, bool is_other) {
    const bool is_across = std::abs(frame_.into().dot(at_target(path).axis)) > 0.9;
    const std::vector<PlacedPart> parts = parts_of(path);
    for (std::size_t n = 0; n < parts.size() && !(is_other && is_across); ++n) {
      const PixelPolygon projection = in_units(part_projection(frame_, parts[n].part, parts[n].pose));
      if (!holds_path(path) && (n == 0 || !is_across)) {
        const char* kDashed = "fill-opacity=\"0.10\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\"";
        add_polygon(projection, is_across || is_other
                                    ? "fill-opacity=\"0\" stroke-width=\"1.2\" stroke-dasharray=\"6 4\""
                                    : kDashed);
      }
      if (!is_other) placer_.avoid_shape(projection);
    }
    for (const auto& [part, pose] : parts) {
      const PixelPolygon section = part_section(frame_, part, pose);
      if (section.empty()) continue;
      add_polygon(in_units(section), is_other ? "fill-opacity=\"0.10\" stroke-width=\"1.2\""
                                              : "fill-opacity=\"0.28\" stroke-width=\"1.8\"");
    }
  }

  void add_measure(const SliceMeasure& measure) {
    const Point from = in_units(measure.from_mm), to = in_units(measure.to_mm);
    const Point way = (to - from).normalized();
    const Point across(-5.0 * way.y(), 5.0 * way.x());
    const std::string data = "M" + point(from) + "L" + point(to) + "M" + point(from - across) + "L" +
                             point(from + across) + "M" + point(to - across) + "L" + point(to + across);
    svg_ += "<path d=\"" + data + "\" stroke=\"#000\" stroke-opacity=\"0.5\" stroke-width=\"4\"/><path d=\"" + data +
            "\" stroke=\"#fff\" stroke-width=\"1.6\"/>\n";
    placer_.avoid(LabelPlacer::Rectangle(from.cwiseMin(to) - Point(5, 5), from.cwiseMax(to) + Point(5, 5)));
    add_label(measure.text, 0.5 * (from + to), "#fff");
  }

  void add_axis(const DrillPath& path) {
    if (!path.is_curved() && std::abs(frame_.into().dot(path.direction())) > 0.99) return;  // a point
    std::string line = "<path fill=\"none\" d=\"";
    if (!path.is_curved()) line = "<path d=\"";
    constexpr double kStepMm = 0.5;
    const char* next = "M";
    for (const Vec3& p_mm : PathCurve(path).places_mm(kStepMm)) {
      line += next + point(in_units(p_mm));
      next = "L";
    }
    line += "\" ";
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
    // Centred over the bar, as far as the picture's edge allows.
    const std::string words = svg_number(length_mm) + " mm";
    const double half = 0.6 * text_width(words, kLabelSize);
    add_text(words, Point(std::max(left.x() + 0.5 * length, half + 4.0), left.y() - 12), "middle", "#fff");
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
    double away_pixels = 0.0;
    for (const Vec3& p_mm : PathCurve(path).places_mm(0.5)) {
      away_pixels = std::max(away_pixels, std::abs(frame_.to_pixel(p_mm).z()));
    }
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

/// The tool where it ends, its tip at the target.
class ToolAtTarget {
 public:
  explicit ToolAtTarget(const DrillPath& path)
      : path_(path), along_(path.direction()), curve_(path), body_(body_of(path)) {}

  /// Whether it holds p, no less deep than that.
  bool holds(const Vec3& p, double from_mm) const {
    if (!curve_.is_straight()) {
      // A short bit's hole along the curve.
      const double depth_mm = curve_.nearest_mm(p);
      if (depth_mm < std::max(0.0, from_mm) || depth_mm > curve_.length_mm()) return false;
      const double off_mm = (p - curve_.at_mm(depth_mm)).norm();
      return off_mm <= std::get<BitProfile>(body_).widest_mm(0.0, curve_.length_mm() - depth_mm);
    }
    const double back_mm = (path_.target_mm - p).dot(along_);
    if (curve_.length_mm() - back_mm < from_mm) return false;
    if (const auto* const plate = std::get_if<BitBody>(&body_)) return plate->distance_mm(p) <= 0.0;
    return std::get<BitProfile>(body_).contains(back_mm, (p - path_.target_mm + back_mm * along_).squaredNorm());
  }

 private:
  static std::variant<BitProfile, BitBody> body_of(const DrillPath& path) {
    if (!path.screw && path.bit.is_plate()) return BitBody(path.bit, at_target(path));
    return BitProfile(path.screw ? path.screw->outline() : path.bit);
  }

  const DrillPath& path_;
  Vec3 along_;
  PathCurve curve_;
  std::variant<BitProfile, BitBody> body_;
};

/// Red, where the tool's section with the slice lies beyond the bone, from a depth on.
void tint_breach(CtSlice& slice, const SliceScene& scene) {
  if (scene.bone == nullptr || !std::isfinite(scene.red_from_mm)) return;
  const ToolAtTarget tool(scene.path);
  const SliceFrame& frame = slice.frame;
  std::vector<Vec3> places;
  std::vector<std::size_t> pixels;
  for (int row = 0; row < frame.height; ++row) {
    for (int column = 0; column < frame.width; ++column) {
      const Vec3 p = frame.to_patient(Vec3(column, row, 0.0));
      if (!tool.holds(p, scene.red_from_mm)) continue;
      places.push_back(p);
      pixels.push_back(static_cast<std::size_t>(row) * static_cast<std::size_t>(frame.width) +
                       static_cast<std::size_t>(column));
    }
  }
  std::vector<float> distances(places.size());
  scene.bone->distance(places, distances);
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (!(distances[n] > 0.0F)) continue;
    std::uint8_t* rgb = slice.image.rgb.data() + 3 * pixels[n];
    rgb[0] = static_cast<std::uint8_t>(170 + rgb[0] / 3);
    rgb[1] = static_cast<std::uint8_t>(rgb[1] / 3);
    rgb[2] = static_cast<std::uint8_t>(rgb[2] / 3);
  }
}

/// The bone and the path with some room around.
Box3 shown_box(const DrillPath& path, Box3 box) {
  const double room_mm = box.isEmpty() ? 25.0 : 5.0;
  for (const Vec3& p_mm : PathCurve(path).places_mm(0.5)) box.extend(p_mm);
  if (const std::optional<BodyBehind> head = head_of(path)) {
    box.extend(Vec3(head->pose.tip_mm - head->outline.length_mm * head->pose.axis));
  }
  return Box3(box.min() - Vec3::Constant(room_mm), box.max() + Vec3::Constant(room_mm));
}

/// Grown so that it is so many times as wide as high.
SliceFrame grown_to_aspect(const SliceFrame& frame, double aspect) {
  return grown_to(frame, static_cast<int>(std::ceil(aspect * frame.height)),
                  static_cast<int>(std::ceil(frame.width / aspect)));
}

double pixel_for(const Box3& box) {
  constexpr double kMaxPixels = 1200.0;  // along the longest side: coarser pixels beyond 240 mm
  return std::max(0.2, box.sizes().maxCoeff() / kMaxPixels);
}

// Of a page's column, drawing units: at 93 mm of paper text of 14 units is 7 points high.
constexpr double kHalfColumn = 260.0;
constexpr double kQuarterColumn = 127.0;
constexpr double kTallAspect = 1.45;
constexpr double kFlatAspect = 1.6;
const Eigen::Vector2d kCrossSizeMm(30.0, 30.0 * kHalfColumn / kFlatAspect / kQuarterColumn);

}  // namespace

std::string slice_svg(const CtSlice& slice, const SliceScene& scene, const std::string& description,
                      const SliceFigureOptions& options) {
  if (slice.frame.width != slice.image.width || slice.frame.height != slice.image.height) {
    fail("slice figure: expected a picture of ", slice.frame.width, " x ", slice.frame.height, " pixels, found ",
         slice.image.width, " x ", slice.image.height);
  }
  SliceDrawing drawing(slice, options);
  CtSlice tinted = slice;
  tint_breach(tinted, scene);
  drawing.add_picture(tinted.image);
  if (scene.bone != nullptr) drawing.add_outline(*scene.bone);
  for (const DrillPath& other : scene.others) drawing.add_tool(other, true);
  drawing.add_tool(scene.path, false);
  drawing.add_axis(scene.path);
  drawing.add_letters();
  drawing.add_scale_bar(options.scale_bar_mm);
  for (const SliceMeasure& measure : scene.measures) drawing.add_measure(measure);
  if (scene.names_ends) drawing.add_ends(scene.path);
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

std::vector<ReportDrawing> path_slices(const CtVolume& ct, const SliceScene& scene, const Box3& bone_bounds_mm) {
  struct Shown {
    SliceFrame frame;
    std::string caption;
  };
  const DrillPath& path = scene.path;
  const Box3 box = shown_box(path, bone_bounds_mm);
  const double pixel_mm = pixel_for(box);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  const auto standard = [&](Plane plane) {
    const SliceFrame frame = plane_frame(plane, middle_mm, box, pixel_mm);
    return Shown{frame, plane_caption(plane, frame)};
  };
  const SliceFrame along = path_frame(path, box, pixel_mm);
  std::array<Shown, 4> views{Shown{along, path_caption(along)}, standard(Plane::kAxial), standard(Plane::kSagittal),
                             standard(Plane::kCoronal)};
  int width = 0;
  for (const Shown& view : views) width = std::max(width, view.frame.width);
  std::vector<ReportDrawing> drawings;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const SliceFrame frame = grown_to(views[i].frame, width, views[i ^ 1U].frame.height);
    drawings.push_back({slice_svg(ct_slice(ct, frame), scene, views[i].caption), views[i].caption});
  }
  return drawings;
}

SliceFrame cross_frame(const DrillPath& path, double depth_mm, const Eigen::Vector2d& size_mm, double pixel_mm) {
  const PathCurve curve(path);
  const Vec3 into = curve.direction_at(depth_mm);
  const Vec3 upward = Vec3::UnitZ() - into.z() * into;
  SliceFrame frame;
  frame.down = upward.norm() > 1e-6 ? Vec3(-upward.normalized()) : Vec3(Vec3::UnitY());
  frame.right = frame.down.cross(into);
  frame.pixel_mm = pixel_mm;
  frame.width = static_cast<int>(std::lround(size_mm.x() / pixel_mm));
  frame.height = static_cast<int>(std::lround(size_mm.y() / pixel_mm));
  frame.origin_mm =
      curve.at_mm(depth_mm) - 0.5 * pixel_mm * ((frame.width - 1) * frame.right + (frame.height - 1) * frame.down);
  return frame;
}

std::vector<ReportDrawing> page_slices(const CtVolume& ct, const SliceScene& scene, const Box3& bone_bounds_mm,
                                       double isthmus_mm) {
  const DrillPath& path = scene.path;
  const Box3 box = shown_box(path, bone_bounds_mm);
  const double pixel_mm = pixel_for(box);
  const Vec3 middle_mm = 0.5 * (path.entry_mm + path.target_mm);
  std::vector<ReportDrawing> drawings;
  const auto add = [&](const SliceFrame& frame, const std::string& caption, double width_units) {
    SliceScene shown = scene;
    shown.names_ends = scene.names_ends && width_units == kHalfColumn;
    drawings.push_back(
        {slice_svg(ct_slice(ct, frame), shown, caption,
                   {.width_units = width_units, .scale_bar_mm = width_units == kHalfColumn ? 10.0 : 5.0}),
         caption});
  };
  const SliceFrame axial = plane_frame(Plane::kAxial, middle_mm, box, pixel_mm);
  const SliceFrame along = path_frame(path, box, pixel_mm);
  const SliceFrame sagittal = plane_frame(Plane::kSagittal, middle_mm, box, pixel_mm);
  add(grown_to_aspect(axial, kTallAspect), plane_caption(Plane::kAxial, axial), kHalfColumn);
  add(grown_to_aspect(along, kTallAspect), path_caption(along), kHalfColumn);
  add(grown_to_aspect(sagittal, kFlatAspect), plane_caption(Plane::kSagittal, sagittal), kHalfColumn);
  const double there_mm = std::clamp(isthmus_mm, 0.0, path.length_mm());
  add(cross_frame(path, there_mm, kCrossSizeMm), "Isthmus, " + readable_number(there_mm, 1) + " mm", kQuarterColumn);
  add(cross_frame(path, path.length_mm(), kCrossSizeMm), "Tip, " + readable_number(path.length_mm(), 1) + " mm",
      kQuarterColumn);
  return drawings;
}

std::vector<ReportDrawing> isthmus_slices(const CtVolume& ct, SliceScene scene, const Box3& bone_bounds_mm,
                                          const PedicleLandmarks& pedicle) {
  scene.names_ends = false;
  const Vec3 half = 0.5 * pedicle.width_mm * pedicle.width_axis;
  const DrillPath& path = scene.path;
  const Box3 box = shown_box(path, bone_bounds_mm);
  const SliceFrame axial = plane_frame(Plane::kAxial, pedicle.isthmus_mm, box, pixel_for(box));
  std::vector<ReportDrawing> drawings;
  const std::string caption = plane_caption(Plane::kAxial, axial);
  drawings.push_back(
      {slice_svg(ct_slice(ct, grown_to_aspect(axial, kTallAspect)), scene, caption, {.width_units = kHalfColumn}),
       caption});
  scene.measures.push_back(
      {pedicle.isthmus_mm - half, pedicle.isthmus_mm + half, readable_number(pedicle.width_mm, 1) + " mm"});
  const double depth_mm = PathCurve(path).nearest_mm(pedicle.isthmus_mm);
  const SliceFrame across = cross_frame(path, depth_mm, {24.0, 24.0 / kTallAspect}, 0.05);
  const std::string width = "Across the pedicle at its isthmus";
  drawings.push_back(
      {slice_svg(ct_slice(ct, across), scene, width, {.width_units = kHalfColumn, .scale_bar_mm = 5.0}), width});
  return drawings;
}

}  // namespace spinaltap
