// What numbers stand for, and where that is published. A numbering is one entry here, and a line of docs/label-maps.md.

#include "core/ct/detail/label_conventions.h"

#include <algorithm>
#include <array>

namespace spinaltap::detail {
namespace {

constexpr Level kC1 = Level::kC1, kT1 = Level::kT1, kL1 = Level::kL1, kL5 = Level::kL5, kL6 = Level::kL6;
constexpr Level kSacrum = Level::kSacrum, kOther = Level::kNone;

/// VerSe 2019 and 2020: the data's description (osf.io/b2wxj/wiki; Sekuboyina 2021, Med Image Anal 73:102166). 27 is
/// the coccyx. SPINEPS and TPTBox (vert_constants.py) put 100 and 200 on a vertebra's number for its disc and endplate.
constexpr std::array kVerse{NumberRun{1, 25, kC1},          NumberRun{26, 26, kSacrum},  NumberRun{27, 27, kOther},
                            NumberRun{28, 28, Level::kT13}, NumberRun{101, 128, kOther}, NumberRun{201, 228, kOther}};

/// CTSpine1K: 1 to 24 from C1 to L5, 25 is L6 (Deng 2021, arXiv:2105.14711; github MIRACLE-Center/CTSpine1K).
constexpr std::array kCtSpine1K{NumberRun{1, 25, kC1}};

/// TotalSegmentator 2, task `total` (github wasserth/TotalSegmentator, totalsegmentator/map_to_binary.py, class_map,
/// 117 classes). 26 is S1, a part of the sacrum.
constexpr std::array kTotal{NumberRun{25, 25, kSacrum}, NumberRun{27, 50, kL5, -1}, NumberRun{1, 117, kOther}};

/// TotalSegmentator 1, task `total` (there, version 1.5.7, 104 classes).
constexpr std::array kTotalV1{NumberRun{18, 41, kL5, -1}, NumberRun{1, 104, kOther}};

/// TotalSegmentator 2, task `vertebrae_mr` (there, class_map["vertebrae_mr"]).
constexpr std::array kTotalMr{NumberRun{1, 1, kSacrum}, NumberRun{2, 25, kL5, -1}};

/// TotalSegmentator 2, the vertebrae's part of `total` (there, class_map_5_parts["class_map_part_vertebrae"]), as its
/// models and training data have it. 2 is S1.
constexpr std::array kTotalPart{NumberRun{1, 1, kSacrum}, NumberRun{2, 2, kOther}, NumberRun{3, 26, kL5, -1}};

/// TotalSegmentator 2, task `vertebrae_body` (there): all bodies are 1, all discs 2.
constexpr std::array kTotalBody{NumberRun{1, 2, kOther}};

/// TotalSpineSeg (github neuropoly/totalspineseg, totalspineseg/resources/labels_maps/tss_map.json). 1 and 2 are the
/// cord and the canal, 47 is L7, 63 to 100 are discs.
constexpr std::array kTotalSpineSeg{NumberRun{1, 2, kOther},   NumberRun{11, 17, kC1},    NumberRun{21, 32, kT1},
                                    NumberRun{41, 46, kL1},    NumberRun{47, 47, kOther}, NumberRun{50, 50, kSacrum},
                                    NumberRun{63, 100, kOther}};

/// VertebralBodiesCT (huggingface.co/fhofmann/VertebralBodiesCT-ResEncM and its labels): bodies without arches.
constexpr std::array kVertebralBodies{NumberRun{1, 12, kT1}, NumberRun{13, 18, kL1}, NumberRun{19, 19, kSacrum},
                                      NumberRun{20, 20, kOther}, NumberRun{21, 21, Level::kT13}};

/// SPIDER (van der Graaf 2024, Sci Data 11:264; zenodo.org/records/8009680): from the lowest lumbar vertebra up; 100 is
/// the canal, 101 to 125 vertebrae that are seen in part, 201 to 225 discs. So are the vertebrae of CADS (github
/// murong-xu/CADS, resources/info/labelmap.md, model 552) and of TotalSegmentator 1's part.
constexpr std::array kSpider{NumberRun{1, 24, kL5, -1}, NumberRun{25, 25, kOther}, NumberRun{100, 125, kOther},
                             NumberRun{201, 225, kOther}};

/// VISTA3D (github Project-MONAI/VISTA, data/jsons/label_dict.json, 132 classes). 127 is S1.
constexpr std::array kVista3d{NumberRun{33, 56, kL5, -1}, NumberRun{97, 97, kSacrum}, NumberRun{131, 131, kL6},
                              NumberRun{1, 132, kOther}};

/// As people number by hand: by the number in the level's own name.
constexpr std::array kLumbar{NumberRun{1, 6, kL1}};
constexpr std::array kThoracic{NumberRun{1, 12, kT1}, NumberRun{13, 13, Level::kT13}};

constexpr std::array kNumberings{
    LabelNumbering{LabelConvention::verse, "VerSe", "verse", false, kVerse},
    LabelNumbering{LabelConvention::ctspine1k, "CTSpine1K", "ctspine1k", false, kCtSpine1K},
    LabelNumbering{LabelConvention::totalsegmentator, "TotalSegmentator 2", "totalsegmentator", false, kTotal},
    LabelNumbering{LabelConvention::totalsegmentator_v1, "TotalSegmentator 1", "totalsegmentator_v1", false, kTotalV1},
    LabelNumbering{LabelConvention::totalsegmentator_mr, "TotalSegmentator's vertebrae_mr", "totalsegmentator_mr",
                   false, kTotalMr},
    LabelNumbering{LabelConvention::totalsegmentator_part, "TotalSegmentator's part of vertebrae",
                   "totalsegmentator_part", false, kTotalPart},
    LabelNumbering{LabelConvention::totalsegmentator_body, "TotalSegmentator's vertebrae_body", "totalsegmentator_body",
                   true, kTotalBody},
    LabelNumbering{LabelConvention::totalspineseg, "TotalSpineSeg", "totalspineseg", false, kTotalSpineSeg},
    LabelNumbering{LabelConvention::vertebralbodiesct, "VertebralBodiesCT", "vertebralbodiesct", true,
                   kVertebralBodies},
    LabelNumbering{LabelConvention::spider, "SPIDER", "spider", false, kSpider},
    LabelNumbering{LabelConvention::vista3d, "VISTA3D", "vista3d", false, kVista3d},
    LabelNumbering{LabelConvention::lumbar, "a count from L1", "lumbar", false, kLumbar},
    LabelNumbering{LabelConvention::thoracic, "a count from T1", "thoracic", false, kThoracic},
};

const NumberRun* run_of(std::span<const NumberRun> runs, long long number) {
  const auto found = std::find_if(runs.begin(), runs.end(),
                                  [&](const NumberRun& run) { return number >= run.first && number <= run.last; });
  return found == runs.end() ? nullptr : &*found;
}

}  // namespace

Level LabelNumbering::level_of(long long number) const {
  const NumberRun* const run = run_of(runs, number);
  if (run == nullptr || run->level == Level::kNone) return Level::kNone;
  const long long level = static_cast<int>(run->level) + run->step * (number - run->first);
  return level_from_number(level).value_or(Level::kNone);
}

bool LabelNumbering::knows(long long number) const { return run_of(runs, number) != nullptr; }

std::span<const LabelNumbering> label_numberings() { return kNumberings; }

const LabelNumbering* numbering_of(LabelConvention convention) {
  const auto found = std::find_if(kNumberings.begin(), kNumberings.end(),
                                  [&](const LabelNumbering& one) { return one.convention == convention; });
  return found == kNumberings.end() ? nullptr : &*found;
}

}  // namespace spinaltap::detail
