#include "apps/report/html_report.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include "apps/report/png.h"
#include "apps/report/text.h"
#include "core/base/error.h"
#include "core/base/version.h"

namespace spinaltap {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #f3f5f7; color: #1a2026; line-height: 1.45;
  font: 16px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", Arial, sans-serif; }
svg { font-family: inherit; display: block; width: 100%; height: auto; }
main { max-width: 1100px; margin: 0 auto; padding: 28px 32px 20px; background: #fff; }
header { border-bottom: 3px solid #0072b2; padding-bottom: 12px; margin-bottom: 20px; }
h1 { font-size: 28px; line-height: 1.2; margin: 0 0 6px; overflow-wrap: anywhere; }
h2 { font-size: 20px; margin: 34px 0 12px; padding-bottom: 4px; border-bottom: 1px solid #d9dee2; }
p { margin: 8px 0; max-width: 82ch; overflow-wrap: anywhere; }
.purpose { color: #4a545d; font-size: 14px; margin: 0; max-width: none; }
.purpose strong { color: #a33b00; }
.note { border-left: 4px solid #e69f00; background: #fdf6e6; padding: 8px 14px; margin: 12px 0; max-width: none; }
.tables { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); gap: 0 36px; }
table { width: 100%; border-collapse: collapse; font-size: 15px; align-self: start; }
tr { border-bottom: 1px solid #e4e8eb; }
th, td { padding: 5px 0; vertical-align: baseline; }
th { text-align: left; font-weight: 400; color: #4a545d; padding-right: 16px; }
td.value { text-align: right; font-variant-numeric: tabular-nums; font-weight: 600; white-space: nowrap; }
td.long { white-space: normal; overflow-wrap: anywhere; }
table.grid { margin-top: 10px; }
table.grid thead th { text-align: right; vertical-align: bottom; }
table.grid th:first-child { text-align: left; }
table.grid td { text-align: right; padding-left: 14px; font-variant-numeric: tabular-nums; }
td.unit { width: 4.6em; padding-left: 8px; color: #4a545d; white-space: nowrap; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(440px, 100%), 1fr)); gap: 18px;
  margin-top: 14px; }
.drawings { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(480px, 100%), 1fr)); gap: 20px;
  align-items: start; margin-top: 14px; }
figure { margin: 0; break-inside: avoid; }
figure img { display: block; width: 100%; height: auto; border-radius: 3px; }
figure.wide { margin: 14px 0 20px; }
svg.slice { border-radius: 3px; background: #000; }
figcaption { font-size: 14px; color: #4a545d; padding-top: 6px; }
footer { margin-top: 36px; padding-top: 10px; border-top: 1px solid #d9dee2; color: #6a747d; font-size: 13px; }
.subtitle { color: #4a545d; font-size: 13px; margin: 2px 0 0; max-width: none; }
.columns { display: grid; grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 22px; }
.columns.single { grid-template-columns: minmax(0, 1fr); }
.column h3 { font-size: 18px; margin: 12px 0 2px; }
.verdict { margin: 0 0 8px; font-size: 14px; }
.badge { display: inline-block; min-width: 1.7em; text-align: center; color: #fff; font-weight: 700; border-radius: 3px;
  padding: 0 7px; margin-right: 8px; background: #00795a; }
.badge.bad { background: #c62828; }
.slices { display: grid; grid-template-columns: repeat(4, minmax(0, 1fr)); gap: 6px; }
.slices figure { grid-column: span 2; }
.slices figure.narrow { grid-column: span 1; }
.column figcaption, .pictures.row figcaption { font-size: 12px; padding-top: 2px; line-height: 1.25; }
.column .tables { grid-template-columns: 1fr 1fr; gap: 0 18px; margin-top: 8px; }
.single .column { display: grid; grid-template-columns: 1fr 1fr; gap: 0 22px; align-items: start; }
.single .column h3, .single .column .verdict { grid-column: 1 / -1; }
.column table { font-size: 13px; }
.column th, .column td { padding: 2px 0; }
.column th { padding-right: 6px; }
.column td.unit { width: auto; padding-left: 4px; }
.column td.value { white-space: nowrap; }
.column figure.wide { margin: 8px 0 0; }
.column h4 { font-size: 13px; margin: 8px 0 2px; }
.column ul { margin: 0; padding-left: 16px; font-size: 13px; line-height: 1.35; }
.column li.warning { color: #a33b00; font-weight: 600; }
.pictures.row { grid-template-columns: repeat(4, minmax(0, 1fr)); gap: 8px; }
.key { font-size: 12px; color: #4a545d; margin: 8px 0 0; max-width: none; }
.sign { display: grid; grid-template-columns: 3fr 1fr; gap: 22px; font-size: 12px; color: #4a545d; margin-top: 24px; }
.sign span { border-top: 1px solid #8b949c; padding-top: 2px; }
@media (max-width: 640px) { main { padding: 16px; } }
@media (max-width: 760px) { .columns, .single .column { grid-template-columns: minmax(0, 1fr); }
  .pictures.row { grid-template-columns: 1fr 1fr; } }
@media print {
  @page { size: A4 portrait; margin: 8mm 10mm; }
  body { background: #fff; }
  main { max-width: none; padding: 0; }
  header { padding-bottom: 3pt; margin-bottom: 0; border-bottom-width: 1.5pt; }
  h1 { font-size: 15pt; margin: 0 0 1pt; }
  h2 { font-size: 12pt; margin-top: 14pt; }
  h2, h2 + p { break-after: avoid; }
  body, .note { font-size: 9.5pt; }
  .subtitle, .purpose { font-size: 7pt; line-height: 1.3; }
  table, figcaption { font-size: 8pt; }
  .tables { grid-template-columns: 1fr 1fr; gap: 0 20px; }
  .drawings { grid-template-columns: 1fr 1fr; gap: 10px; }
  .pictures { grid-template-columns: repeat(2, 1fr); gap: 10px; }
  .sheet { break-after: page; }
  .sheet .note { font-size: 7.5pt; margin: 2pt 0; padding: 1pt 6pt; line-height: 1.25; }
  .sheet h2 { margin: 0 0 2pt; }
  .columns { grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0 4mm; }
  .columns.single { grid-template-columns: minmax(0, 1fr); }
  .single .column { grid-template-columns: 1fr 1fr; gap: 0 4mm; }
  .column h3 { font-size: 10.5pt; margin: 3pt 0 0; }
  .verdict { font-size: 7.2pt; margin: 0 0 2pt; }
  .slices { gap: 1mm; }
  .column figcaption, .pictures.row figcaption { font-size: 6.5pt; padding-top: 0.5pt; line-height: 1.15; }
  .column .tables { gap: 0 3mm; margin-top: 1.5pt; }
  .column table { font-size: 7pt; line-height: 1.2; }
  .column th, .column td { padding: 0.7pt 0; }
  .column figure.wide { margin: 1.5pt 0 0; }
  .column h4 { font-size: 7.5pt; margin: 2pt 0 0; }
  .column ul { font-size: 6.8pt; line-height: 1.15; padding-left: 9pt; }
  .pictures.row { grid-template-columns: repeat(4, minmax(0, 1fr)); gap: 1mm; margin-top: 3pt; }
  .key { font-size: 6.5pt; margin: 2pt 0 0; line-height: 1.25; }
  .sign { font-size: 7pt; margin-top: 13pt; }
  footer { font-size: 7pt; margin-top: 8pt; padding-top: 3pt; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

constexpr std::string_view kPurpose =
    "<strong>Research and training software, not a medical device.</strong> Not for diagnosis, planning or treatment "
    "of patients.";

constexpr std::size_t kLongValue = 24;  ///< bytes; longer values may wrap

std::string figure(const std::string& content, const std::string& caption, std::string_view attributes = "") {
  std::string html = "<figure" + std::string(attributes) + ">\n" + content;
  if (!caption.empty()) html += "<figcaption>" + escape_html(caption) + "</figcaption>\n";
  return html + "</figure>\n";
}

std::string table(std::span<const ReportRow> rows) {
  std::string html = "<table>\n";
  for (const ReportRow& row : rows) {
    const bool is_long = row.value.size() > kLongValue;
    html += "<tr><th scope=\"row\">" + escape_html(row.name) + "</th><td class=\"value" + (is_long ? " long" : "") +
            "\">" + escape_html(row.value) + "</td><td class=\"unit\">" + escape_html(row.unit) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

std::string tables(std::span<const ReportRow> rows, std::size_t two_columns_from) {
  if (rows.empty()) return {};
  const std::size_t first = rows.size() < two_columns_from ? rows.size() : (rows.size() + 1) / 2;
  std::string html = "<div class=\"tables\">\n" + table(rows.first(first));
  if (first < rows.size()) html += table(rows.subspan(first));
  return html + "</div>\n";
}

std::string grid(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  if (rows.empty()) return {};
  std::string html = "<table class=\"grid\">\n<thead><tr>";
  for (const std::string& name : head) html += "<th scope=\"col\">" + escape_html(name) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    if (row.size() != head.size()) {
      fail("report: expected rows of ", head.size(), " cells, found one of ", row.size());
    }
    html += "<tr>";
    for (std::size_t n = 0; n < row.size(); ++n) {
      html += n == 0 ? "<th scope=\"row\">" + escape_html(row[n]) + "</th>" : "<td>" + escape_html(row[n]) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

std::string picture_figure(const ReportPicture& picture) {
  return figure("<img alt=\"" + escape_html(picture.caption) + "\" width=\"" + std::to_string(picture.image.width) +
                    "\" height=\"" + std::to_string(picture.image.height) + "\" src=\"data:image/png;base64," +
                    base64(encode_png(picture.image)) + "\">\n",
                picture.caption);
}

std::string column_html(const SheetColumn& column) {
  std::string html = "<div class=\"column\">\n<h3>" + escape_html(column.heading) + "</h3>\n<p class=\"verdict\">";
  if (!column.badge.empty()) {
    html += std::string("<span class=\"badge") + (column.is_good ? "" : " bad") + "\">" + escape_html(column.badge) +
            "</span>";
  }
  html += escape_html(column.verdict) + "</p>\n<div>\n";
  if (!column.slices.empty()) {
    html += "<div class=\"slices\">\n";
    for (std::size_t n = 0; n < column.slices.size(); ++n) {
      html += figure(column.slices[n].svg, column.slices[n].caption, n < column.narrow_from ? "" : " class=\"narrow\"");
    }
    html += "</div>\n";
  }
  html += "</div>\n<div>\n" + tables(column.figures, 2) + grid(column.grid_head, column.grid);
  for (const ReportDrawing& plot : column.plots) html += figure(plot.svg, plot.caption, " class=\"wide\"");
  for (const ReportLines& list : column.lists) {
    if (list.warnings.empty() && list.lines.empty()) continue;
    html += "<h4>" + escape_html(list.heading) + "</h4>\n<ul>\n";
    for (const std::string& line : list.warnings) html += "<li class=\"warning\">" + escape_html(line) + "</li>\n";
    for (const std::string& line : list.lines) html += "<li>" + escape_html(line) + "</li>\n";
    html += "</ul>\n";
  }
  return html + "</div>\n</div>\n";
}

}  // namespace

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::add_heading(const std::string& text) { body_ += "<h2>" + escape_html(text) + "</h2>\n"; }

void HtmlReport::add_text(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }

void HtmlReport::add_note(const std::string& text) { body_ += "<p class=\"note\">" + escape_html(text) + "</p>\n"; }

void HtmlReport::add_table(const std::vector<ReportRow>& rows) {
  constexpr std::size_t kTwoColumnsFrom = 8;
  body_ += tables(rows, kTwoColumnsFrom);
}

void HtmlReport::add_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  body_ += grid(head, rows);
}

void HtmlReport::add_pictures(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return;
  body_ += "<div class=\"pictures\">\n";
  for (const ReportPicture& picture : pictures) body_ += picture_figure(picture);
  body_ += "</div>\n";
}

void HtmlReport::add_svg(const std::string& svg, const std::string& caption) {
  body_ += figure(svg, caption, " class=\"wide\"");
}

void HtmlReport::add_svgs(const std::vector<ReportDrawing>& drawings) {
  if (drawings.empty()) return;
  body_ += "<div class=\"drawings\">\n";
  for (const ReportDrawing& drawing : drawings) body_ += figure(drawing.svg, drawing.caption);
  body_ += "</div>\n";
}

void HtmlReport::add_sheet(const ReportSheet& sheet) {
  if (sheet.columns.empty() || sheet.columns.size() > 2) {
    fail("report: expected a sheet of one or two columns, found ", sheet.columns.size());
  }
  body_ += "<section class=\"sheet\">\n";
  if (!sheet.heading.empty()) add_heading(sheet.heading);
  for (const std::string& note : sheet.notes) add_note(note);
  body_ += std::string("<div class=\"columns") + (sheet.columns.size() == 1 ? " single" : "") + "\">\n";
  for (const SheetColumn& column : sheet.columns) body_ += column_html(column);
  body_ += "</div>\n";
  if (!sheet.pictures.empty()) {
    body_ += "<div class=\"pictures row\">\n";
    for (const ReportPicture& picture : sheet.pictures) body_ += picture_figure(picture);
    body_ += "</div>\n";
  }
  if (!sheet.key.empty()) body_ += "<p class=\"key\">" + escape_html(sheet.key) + "</p>\n";
  body_ += "<div class=\"sign\"><span>Seen and judged by</span><span>Date</span></div>\n</section>\n";
}

void HtmlReport::add_made(const std::string& date, const std::string& command) {
  std::string text = date.empty() ? "" : "Made on " + escape_html(date);
  if (!command.empty()) text += (text.empty() ? "" : " · ") + escape_html(command);
  if (!text.empty()) subtitle_ = "<p class=\"subtitle\">" + text + "</p>\n";
}

std::string HtmlReport::html() const {
  const std::string title = escape_html(title_);
  const std::string program = "SpinalTap " + escape_html(version());
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"generator\" content=\"" +
         program + "\">\n<title>" + title + "</title>\n<style>" + std::string(kStyle) +
         "</style>\n</head>\n<body>\n<main>\n<header>\n<h1>" + title + "</h1>\n<p class=\"purpose\">" + program +
         " · " + std::string(kPurpose) + "</p>\n" + subtitle_ + "</header>\n" + body_ +
         "<footer>Positions are in the CT's patient frame (LPS, mm): x to the patient's left, y to the back, z to the "
         "head.</footer>\n</main>\n</body>\n</html>\n";
}

}  // namespace spinaltap
