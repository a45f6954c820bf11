#include <algorithm>

#include "core/base/text_writer.h"
#include "core/grading/grade.h"
#include "core/grading/neighbour_contact.h"
#include "core/grading/path_doubt.h"

namespace spinaltap {
namespace {

/// Behind the other warnings, before the first note.
void add_warning(const Finding& finding, std::vector<Finding>& findings) {
  const auto first_note =
      std::find_if(findings.begin(), findings.end(), [](const Finding& one) { return !one.is_warning; });
  findings.insert(first_note, finding);
}

Finding finding_of(const PathDoubt& doubt) {
  Finding finding;
  finding.at_mm = doubt.depth_mm;
  finding.place_mm = doubt.place_mm;
  finding.is_warning = true;
  finding.words = in_words(doubt) + ", from " + fixed_text(doubt.depth_mm, 1) + " mm of depth on: ";
  if (doubt.kind == PathDoubt::Kind::made_up_slices) {
    finding.words += "nothing was scanned there";
  } else {
    finding.words += "where it is, the tool stands up to " + fixed_text(-doubt.without_mm, 1) + " mm out of this one";
  }
  return finding;
}

}  // namespace

void note_neighbours(std::span<const Neighbour> neighbours, const DrillPath& path, PathGrade& grade) {
  grade.neighbour = neighbour_contact(neighbours, path);
  if (grade.neighbour->depth_mm > kTouchMm) add_warning(finding_of(*grade.neighbour, path), grade.findings);
}

void note_doubts(const DoubtfulBone& bone, const DrillPath& path, PathGrade& grade) {
  grade.doubts = path_doubts(bone, path);
  for (const PathDoubt& doubt : grade.doubts) add_warning(finding_of(doubt), grade.findings);
}

std::string grade_in_words(const PathGrade& grade) {
  std::string words(1, letter_of(grade.grade));
  for (const PathDoubt& doubt : grade.doubts) {
    words += (&doubt == grade.doubts.data() ? ", but " : ", and ") + in_words(doubt);
  }
  return words;
}

}  // namespace spinaltap
