#include "core/files/measurements_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/files/data_files.h"
#include "tests/support/temporary_folder.h"

namespace spinaltap {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const char* const kMeasurementFiles[] = {"sources.csv", "drilling.csv", "screws.csv", "heat.csv"};

std::string shipped_text(const std::string& name) { return read_whole_file(data_file("measurements/" + name)); }

/// What the reader says of the shipped files with the first `old_text` of one of them changed.
std::string complaint_with(const std::string& name, const std::string& old_text, const std::string& new_text) {
  const test::TemporaryFolder folder;
  for (const char* file : kMeasurementFiles) {
    std::string text = shipped_text(file);
    if (name == file) {
      const std::size_t at = text.find(old_text);
      EXPECT_NE(at, std::string::npos) << old_text;
      if (at != std::string::npos) text.replace(at, old_text.size(), new_text);
    }
    write_whole_file(folder.path() / file, text);
  }
  try {
    read_measurements(folder.path());
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Of a kind of rows with figures: the sources.
template <class Rows>
std::set<std::string> sources_of_rows(const Rows& rows) {
  std::set<std::string> keys;
  for (const auto& row : rows) keys.insert(row.source);
  return keys;
}

TEST(MeasurementsFile, TheShippedOnesAreReadWholeAndEachSourceIsUsed) {
  const Measurements all = shipped_measurements();
  // As many as lines, but for the head: nothing is passed over.
  const std::vector<std::size_t> counts{all.sources.size(), all.drilling.size(), all.screws.size(), all.heat.size()};
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::string text = shipped_text(kMeasurementFiles[i]);
    EXPECT_EQ(counts[i] + 1, static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')))
        << kMeasurementFiles[i];
  }
  EXPECT_GE(all.drilling.size(), 30u);
  EXPECT_GE(all.screws.size(), 26u);
  EXPECT_GE(all.heat.size(), 27u);
  EXPECT_GE(sources_of_rows(all.drilling).size(), 10u);

  std::set<std::string> used = sources_of_rows(all.drilling);
  used.merge(sources_of_rows(all.screws));
  used.merge(sources_of_rows(all.heat));
  std::set<std::string> keys;
  for (const MeasurementSource& source : all.sources) keys.insert(source.key);
  EXPECT_EQ(used, keys);
}

/// Whether a text has this number, by itself and perhaps with zeros behind it.
bool has_number(const std::string& text, double figure) {
  std::string digits;
  append_number(figure, digits);
  for (std::size_t at = text.find(digits); at != std::string::npos; at = text.find(digits, at + 1)) {
    const auto is_digit = [&text](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    if (at > 0 && (is_digit(at - 1) || text[at - 1] == '.')) continue;
    std::size_t end = at + digits.size();
    bool has_point = digits.find('.') != std::string::npos;
    if (!has_point && text.compare(end, 2, ".0") == 0) {
      has_point = true;
      end += 2;
    }
    while (has_point && end < text.size() && text[end] == '0') ++end;
    if (is_digit(end) || (end < text.size() && text[end] == '.' && is_digit(end + 1))) continue;
    return true;
  }
  return false;
}

TEST(MeasurementsFile, FiguresAreInTheQuoteTheyWereCopiedFrom) {
  const Measurements all = shipped_measurements();
  const auto quote_of = [&all](const std::string& key) {
    for (const MeasurementSource& source : all.sources) {
      if (source.key == key) return source.quote;
    }
    return std::string();
  };
  const auto expect_in_quote = [&](const MeasurementRow& row, std::initializer_list<std::optional<double>> figures,
                                   double unit) {
    std::string quote = quote_of(row.source);
    // So printed: "1.50 +/- 0. 40 Nm".
    if (const std::size_t at = quote.find("0. 40"); at != std::string::npos) quote.erase(at + 2, 1);
    for (const std::optional<double>& figure : figures) {
      if (!figure) continue;
      EXPECT_TRUE(has_number(quote, std::round(*figure / unit * 1e6) / 1e6)) << row.source << ": " << *figure;
    }
  };
  const auto low = [](const std::optional<MeasuredRange>& r) { return r ? std::optional(r->low) : std::nullopt; };
  const auto high = [](const std::optional<MeasuredRange>& r) { return r ? std::optional(r->high) : std::nullopt; };
  for (const DrillingMeasurement& row : all.drilling) {
    expect_in_quote(row, {row.thrust_n, row.thrust_sd_n, low(row.thrust_range_n), high(row.thrust_range_n)}, 1.0);
    expect_in_quote(row, {row.torque_n_mm, row.torque_sd_n_mm, low(row.torque_range_n_mm)}, 1.0);
    expect_in_quote(row, {high(row.torque_range_n_mm)}, 1.0);
    if (row.has_noted_conditions) continue;
    expect_in_quote(row, {row.diameter_mm, low(row.feed_mm_min), high(row.feed_mm_min)}, 1.0);
  }
  for (const HeatMeasurement& row : all.heat) {
    expect_in_quote(row, {row.temperature_c, row.temperature_sd_c, row.distance_mm, row.axial_force_n}, 1.0);
    expect_in_quote(row, {low(row.temperature_range_c), high(row.temperature_range_c), row.feed_mm_rev}, 1.0);
    expect_in_quote(row, {low(row.diameter_mm), high(row.diameter_mm)}, 1.0);
  }
  for (const ScrewMeasurement& row : all.screws) {
    const std::string quote = quote_of(row.source);
    expect_in_quote(row, {row.hu, row.hu_sd, row.t_score_sd, row.outer_diameter_mm}, 1.0);
    expect_in_quote(row, {row.pullout_n, row.pullout_sd_n}, quote.find("kN") == std::string::npos ? 1.0 : 1000.0);
    const double n_cm = quote.find("kgf-cm") == std::string::npos ? 10.0 : 98.0665;
    expect_in_quote(row, {row.torque_n_mm, row.torque_sd_n_mm}, quote.find(" Nm") == std::string::npos ? n_cm : 1000.0);
  }
}

TEST(MeasurementsFile, WhatASourceLeavesOutIsEmpty) {
  const Measurements all = shipped_measurements();
  const DrillingMeasurement& first = all.drilling.front();
  EXPECT_EQ(first.source, "macavelia2012");
  EXPECT_EQ(first.species, "human");
  EXPECT_EQ(first.tissue, MeasuredTissue::cortical);
  EXPECT_FALSE(first.density_g_cm3);
  EXPECT_FALSE(first.web_mm);
  EXPECT_EQ(first.rpm->low, 1000.0);
  EXPECT_EQ(first.rpm->high, 1000.0);
  EXPECT_EQ(first.thrust_n, 198.4);
  EXPECT_FALSE(first.thrust_range_n);
  EXPECT_EQ(first.n, 16);
  EXPECT_TRUE(first.is_fitted);
  const auto is_cited = [](const DrillingMeasurement& row) { return row.source == "powers_cited"; };
  const auto powers = std::find_if(all.drilling.begin(), all.drilling.end(), is_cited);
  ASSERT_NE(powers, all.drilling.end());
  EXPECT_FALSE(powers->thrust_n);
  EXPECT_EQ(powers->thrust_range_n->low, 0.6);
  EXPECT_EQ(powers->thrust_range_n->high, 29.6);
  EXPECT_FALSE(powers->rpm);
  EXPECT_TRUE(powers->is_fitted);
}

TEST(MeasurementsFile, DamageIsToldWithFileLineAndColumn) {
  EXPECT_EQ(complaint_with("drilling.csv", "198.4", "198.4"), "");
  for (const char* bad : {"0", "-198.4", "nan", "inf", "198,4", "about 198", "\"19\"8"}) {
    const std::string told = complaint_with("drilling.csv", "198.4", bad);
    EXPECT_THAT(told, HasSubstr("drilling.csv")) << bad;
    EXPECT_THAT(told, HasSubstr("line 2")) << bad;
    if (std::string(bad) != "198,4") {
      EXPECT_THAT(told, HasSubstr("thrust_n")) << bad;
    }
  }
  EXPECT_THAT(complaint_with("drilling.csv", ",3.2,", ",0,"), HasSubstr("diameter_mm"));
  EXPECT_THAT(complaint_with("drilling.csv", "14.2", "-1"), HasSubstr("thrust_sd_n"));
  EXPECT_THAT(complaint_with("drilling.csv", "0.6 to 29.6", "29.6 to 0.6"), HasSubstr("thrust_range_n"));
  EXPECT_THAT(complaint_with("drilling.csv", "0.6 to 29.6", "0.6-29.6"), HasSubstr("thrust_range_n"));
  EXPECT_THAT(complaint_with("drilling.csv", "4.22 to 18.93", "10 to 18.93"), HasSubstr("around the figure"));
  EXPECT_THAT(complaint_with("drilling.csv", "198.4,14.2,,not_stated", "198.4,14.2,,peak"), HasSubstr("thrust_kind"));
  EXPECT_THAT(complaint_with("drilling.csv", ",16,femurs", ",1.5,femurs"), HasSubstr("whole number"));
  EXPECT_THAT(complaint_with("drilling.csv", "198.4,14.2,,not_stated,186.3,16.9,,not_stated", ",,,,,,,"),
              HasSubstr("a thrust or a torque"));
  EXPECT_THAT(complaint_with("drilling.csv", "198.4,14.2", ",14.2"), HasSubstr("thrust_sd_n"));
  EXPECT_THAT(complaint_with("drilling.csv", "read,yes", "read,maybe"), HasSubstr("fitted"));
  EXPECT_THAT(complaint_with("drilling.csv", "macavelia2012", "nobody2012"),
              HasSubstr("a key of sources.csv as source"));
  EXPECT_THAT(complaint_with("screws.csv", "1055.5", "0"), HasSubstr("screws.csv, line 2"));
  EXPECT_THAT(complaint_with("screws.csv", "580.8,insertion", "580.8,"), HasSubstr("torque_kind"));
  EXPECT_THAT(complaint_with("heat.csv", "31.4 to 55.5", ""), HasSubstr("a temperature"));
  EXPECT_THAT(complaint_with("heat.csv", "internal,,,38.5", "river,,,38.5"), HasSubstr("irrigation"));
  EXPECT_THAT(complaint_with("sources.csv", "orelaja2020", "macavelia2012"), HasSubstr("each key once"));
  EXPECT_THAT(complaint_with("sources.csv", "macavelia2012,own", "macavelia2012,"), HasSubstr("report"));
}

TEST(MeasurementsFile, ColumnsMayStandInAnyOrderButAllAreThere) {
  EXPECT_THAT(complaint_with("drilling.csv", "thrust_n", "force_n"), HasSubstr("a column thrust_n"));
  EXPECT_THAT(complaint_with("drilling.csv", "thrust_n", "torque_n_mm"), HasSubstr("found two"));
  EXPECT_THAT(complaint_with("heat.csv", "note\n", "note,colour\n"), HasSubstr("24 columns"));
  const test::TemporaryFolder folder;
  for (const char* file : kMeasurementFiles) write_whole_file(folder.path() / file, shipped_text(file));
  const std::string columns = "quote,read,url,doi,year,journal,title,authors,report,key";
  write_whole_file(folder.path() / "sources.csv", columns + ",colour\n\"a, b\",c,d,,,,,,own,e,red\n");
  EXPECT_THROW(read_measurements(folder.path()), Error);
  write_whole_file(folder.path() / "sources.csv", columns + "\r\n\"a, b\",c,d,,,,,,own,e\r\n");
  write_whole_file(folder.path() / "screws.csv", shipped_text("screws.csv"));
  try {
    read_measurements(folder.path());
    ADD_FAILURE() << "rows have keys that are gone";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("drilling.csv, line 2"));
  }
  fs::remove(folder.path() / "heat.csv");
  EXPECT_THROW(read_measurements(folder.path()), Error);
}

}  // namespace
}  // namespace spinaltap
