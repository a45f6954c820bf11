#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/trunks/doubt_figures.h"

namespace spinaltap::test {

/// One level of one CT that is whole in it, and how right what was found of it is.
struct LevelRow {
  std::string ct;  ///< a trunk's seed, or what was done to which CT
  double slice_mm = 0.0;
  std::string level;
  const LevelReport* found = nullptr;  ///< none: it was missed
  double dice = 0.0;
  double centre_mm = 0.0;  ///< between the bodies' middles
  bool is_wrong = false;
  bool is_told = false;
  DoubtFigures figures{};
};

/// A CSV table of such rows, with what the doubt of each is reckoned from: train_doubt.py learns from it.
class LevelTable {
 public:
  explicit LevelTable(const std::filesystem::path& file);
  void add(const LevelRow& row);

 private:
  std::filesystem::path file_;
  std::ofstream csv_;
};

/// The Dice from which on a level is right: 0.9 in slices of up to 1.5 mm, 0.8 in thicker ones.
inline double right_dice_at(double slice_mm) { return slice_mm <= 1.5 ? 0.9 : 0.8; }

}  // namespace spinaltap::test
