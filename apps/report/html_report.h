#pragma once

#include <string>
#include <vector>

#include "core/base/image.h"

namespace spinaltap {

/// A line of a table: a name, its value as text, and the unit (may be empty).
struct ReportRow {
  std::string name;
  std::string value;
  std::string unit;
};

/// A picture and what it shows.
struct ReportPicture {
  Image image;
  std::string caption;
};

/// A drawing: an <svg> element as svg_plot() and slice_svg() make them. It goes in as it is; only its caption is
/// escaped.
struct ReportDrawing {
  std::string svg;
  std::string caption;
};

/// Builds a report as one HTML5 file that needs nothing else: style and pictures inside, no scripts, no references.
/// All text is escaped; names from files cannot bring in markup. Parts appear in the order they are added.
class HtmlReport {
 public:
  explicit HtmlReport(std::string title);

  void add_heading(const std::string& text);
  void add_text(const std::string& text);
  /// A note set apart from the text.
  void add_note(const std::string& text);
  /// In two columns of rows from eight rows on, where the page is wide enough.
  void add_table(const std::vector<ReportRow>& rows);
  /// Rows of as many cells as `head` has; the first column is text, the others are numbers. Throws Error where a row
  /// has other than so many. Nothing where there are no rows.
  void add_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows);
  /// Side by side, as many as fit. Throws Error on an empty picture.
  void add_pictures(const std::vector<ReportPicture>& pictures);
  /// Over the whole width.
  void add_svg(const std::string& svg, const std::string& caption = "");
  /// Two side by side.
  void add_svgs(const std::vector<ReportDrawing>& drawings);

  /// The whole file.
  std::string html() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace spinaltap
