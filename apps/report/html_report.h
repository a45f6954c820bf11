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

/// A list of lines of a side, those that are warnings set apart.
struct ReportLines {
  std::string heading;
  std::vector<std::string> warnings;
  std::vector<std::string> lines;
};

/// What a column of a sheet says of one path or pedicle, from top to bottom. Empty parts are left out.
struct SheetColumn {
  std::string heading;
  std::string badge;    ///< a grade's letter, or a word
  bool is_good = true;  ///< of the badge's colour
  std::string verdict;  ///< beside the badge
  std::vector<ReportDrawing> slices;
  std::size_t narrow_from = 99;  ///< slices from here on are half as wide
  std::vector<ReportRow> figures;
  std::vector<std::string> grid_head;  ///< of a small table
  std::vector<std::vector<std::string>> grid;
  std::vector<ReportDrawing> plots;  ///< over the whole width
  std::vector<ReportLines> lists;
};

/// A page of paper, A4 upright: at most two columns and a row of pictures.
struct ReportSheet {
  std::string heading;               ///< none on the first sheet: the report's own title stands there
  std::vector<std::string> notes;    ///< set apart, above all
  std::vector<SheetColumn> columns;  ///< one or two
  std::vector<ReportPicture> pictures;
  std::string key;  ///< what colours mean
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

  /// A page of its own on paper. Throws Error where it has not one or two columns.
  void add_sheet(const ReportSheet& sheet);
  /// Small print below the title: when it was made, and with what command; either may be empty.
  void add_made(const std::string& date, const std::string& command);

  /// The whole file.
  std::string html() const;

 private:
  std::string title_;
  std::string subtitle_;
  std::string body_;
};

}  // namespace spinaltap
