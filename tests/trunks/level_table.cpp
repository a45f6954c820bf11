#include "tests/trunks/level_table.h"

#include "core/base/error.h"
#include "core/base/text_writer.h"

namespace spinaltap::test {
LevelTable::LevelTable(const std::filesystem::path& file) : file_(file), csv_(file) {
  csv_ << "seed,slice_mm,level,found,dice,centre_mm,is_wrong,is_suspect,severity,name,probability";
  for (const char* const name : kDoubtFigures) csv_ << ',' << name;
  csv_ << '\n';
}

void LevelTable::add(const LevelRow& row) {
  TextWriter line(6);
  line << row.ct << ',' << row.slice_mm << ',' << row.level << ',' << (row.found != nullptr ? 1 : 0) << ',' << row.dice
       << ',' << row.centre_mm << ',' << (row.is_wrong ? 1 : 0) << ',' << (row.is_told ? 1 : 0) << ',';
  if (row.found != nullptr) {
    const auto& probabilities = row.found->name_probabilities;
    line << row.found->severity << ',' << row.found->name << ','
         << (probabilities.empty() ? 0.0 : probabilities.front().probability);
    for (const double figure : row.figures) line << ',' << figure;
  } else {
    line << ",," << std::string(kDoubtFigures.size(), ',');
  }
  csv_ << line.str() << '\n';
  csv_.flush();
  if (!csv_) fail("cannot write ", file_.string());
}

}  // namespace spinaltap::test
