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
@media (max-width: 640px) { main { padding: 16px; } }
@media print {
  @page { margin: 14mm; }
  body { background: #fff; }
  main { max-width: none; padding: 0; }
  h1 { font-size: 18pt; }
  h2 { font-size: 13pt; margin-top: 16pt; }
  h2, h2 + p { break-after: avoid; }
  body, .note { font-size: 10pt; }
  table, .purpose, figcaption { font-size: 8.5pt; }
  .tables { grid-template-columns: 1fr 1fr; gap: 0 20px; }
  .drawings { grid-template-columns: 1fr 1fr; gap: 10px; }
  .pictures { grid-template-columns: repeat(2, 1fr); gap: 10px; }
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

}  // namespace

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::add_heading(const std::string& text) { body_ += "<h2>" + escape_html(text) + "</h2>\n"; }

void HtmlReport::add_text(const std::string& text) { body_ += "<p>" + escape_html(text) + "</p>\n"; }

void HtmlReport::add_note(const std::string& text) { body_ += "<p class=\"note\">" + escape_html(text) + "</p>\n"; }

void HtmlReport::add_table(const std::vector<ReportRow>& rows) {
  if (rows.empty()) return;
  constexpr std::size_t kTwoColumnsFrom = 8;
  const std::span<const ReportRow> all(rows);
  const std::size_t first = rows.size() < kTwoColumnsFrom ? rows.size() : (rows.size() + 1) / 2;
  body_ += "<div class=\"tables\">\n" + table(all.first(first));
  if (first < rows.size()) body_ += table(all.subspan(first));
  body_ += "</div>\n";
}

void HtmlReport::add_table(const std::vector<std::string>& head, const std::vector<std::vector<std::string>>& rows) {
  if (rows.empty()) return;
  body_ += "<table class=\"grid\">\n<thead><tr>";
  for (const std::string& name : head) body_ += "<th scope=\"col\">" + escape_html(name) + "</th>";
  body_ += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    if (row.size() != head.size()) {
      fail("report: expected rows of ", head.size(), " cells, found one of ", row.size());
    }
    body_ += "<tr>";
    for (std::size_t n = 0; n < row.size(); ++n) {
      body_ += n == 0 ? "<th scope=\"row\">" + escape_html(row[n]) + "</th>" : "<td>" + escape_html(row[n]) + "</td>";
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody>\n</table>\n";
}

void HtmlReport::add_pictures(const std::vector<ReportPicture>& pictures) {
  if (pictures.empty()) return;
  body_ += "<div class=\"pictures\">\n";
  for (const ReportPicture& picture : pictures) {
    const std::string image = "<img alt=\"" + escape_html(picture.caption) + "\" width=\"" +
                              std::to_string(picture.image.width) + "\" height=\"" +
                              std::to_string(picture.image.height) + "\" src=\"data:image/png;base64," +
                              base64(encode_png(picture.image)) + "\">\n";
    body_ += figure(image, picture.caption);
  }
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

std::string HtmlReport::html() const {
  const std::string title = escape_html(title_);
  const std::string program = "SpinalTap " + escape_html(version());
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"generator\" content=\"" +
         program + "\">\n<title>" + title + "</title>\n<style>" + std::string(kStyle) +
         "</style>\n</head>\n<body>\n<main>\n<header>\n<h1>" + title + "</h1>\n<p class=\"purpose\">" + program +
         " · " + std::string(kPurpose) + "</p>\n</header>\n" + body_ +
         "<footer>Positions are in the CT's patient frame (LPS, mm): x to the patient's left, y to the back, z to the "
         "head.</footer>\n</main>\n</body>\n</html>\n";
}

}  // namespace spinaltap
