#include "core/grading/screw_breach.h"

#include "core/grading/fast_breach.h"
#include "core/tool/plate.h"

namespace spinaltap {

struct ScrewGrader::Impl {
  Impl(const WallDistance& walls, const GradeOptions& options) : field(walls, options) {}
  BreachField field;
};

ScrewGrader::ScrewGrader(const WallDistance& walls, const GradeOptions& options) {
  check_grade_options(options);
  impl_ = std::make_unique<const Impl>(walls, options);
}
ScrewGrader::ScrewGrader(ScrewGrader&&) noexcept = default;
ScrewGrader& ScrewGrader::operator=(ScrewGrader&&) noexcept = default;
ScrewGrader::~ScrewGrader() = default;

ScrewBreach ScrewGrader::grade(const DrillPath& path, ScrewSides sides) const {
  check_turns(path.bit, "a grade");
  FastBreach fast(impl_->field, path);
  const FoundBreaches found = fast.find();
  ScrewBreach breach;
  breach.outer_mm = found.outer.breach_mm;
  breach.canal_mm = found.canal.breach_mm;
  const FoundBreach& larger = found.larger();
  if (!(larger.breach_mm > 0.0)) return breach;
  breach.breach_mm = larger.breach_mm;
  breach.depth_mm = larger.depth_mm;
  breach.side = fast.side_of(larger);
  breach.is_canal = larger.is_canal;
  breach.side_breach_mm = fast.sides(found, sides);
  return breach;
}

}  // namespace spinaltap
