#pragma once

#include <span>
#include <string_view>

#include "core/ct/label_volume.h"

namespace spinaltap::detail {

/// Numbers from `first` to `last`, which stand for levels in a row from `level` on.
struct NumberRun {
  int first = 0;
  int last = 0;
  Level level = Level::kNone;  ///< of `first`; kNone: all are known, and none is a whole vertebra
  int step = 1;                ///< 1: counted down the spine; -1: up
};

/// What the numbers of a kind of label map stand for.
struct LabelNumbering {
  LabelConvention convention = LabelConvention::none;
  std::string_view name;         ///< for people: "VerSe"
  std::string_view keyword;      ///< for options and files: "verse"
  bool has_bodies_only = false;  ///< its labels are bodies without arches
  std::span<const NumberRun> runs;

  /// kNone for what is no whole vertebra.
  Level level_of(long long number) const;
  /// Whether the numbering has the number at all.
  bool knows(long long number) const;
};

/// All numberings that are known, each with its public source in label_conventions.cpp.
std::span<const LabelNumbering> label_numberings();

/// One of them; null for automatic, names and none.
const LabelNumbering* numbering_of(LabelConvention convention);

}  // namespace spinaltap::detail
