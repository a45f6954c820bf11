// Codes: DICOM PS3.16, CID 7603 "Vertebra" (with the SNOMED-RT codes of its editions before 2024), CID 4031 for the
// sacrum, rib and bone.

#include "core/ct/detail/dicom_level_codes.h"

#include <algorithm>
#include <array>

#include "core/base/text_fields.h"

namespace spinaltap::detail {
namespace {

struct LevelCode {
  Level level;
  std::string_view sct;
  std::string_view srt;
};

constexpr Level level_at(int number) { return static_cast<Level>(number); }

constexpr std::array<LevelCode, 25> kLevels{{
    {level_at(1), "14806007", "T-11610"},    {level_at(2), "39976000", "T-11620"},
    {level_at(3), "113205007", "T-11630"},   {level_at(4), "5329002", "T-11640"},
    {level_at(5), "36978003", "T-11650"},    {level_at(6), "36054005", "T-11660"},
    {level_at(7), "87391001", "T-11670"},    {level_at(8), "64864005", "T-11710"},
    {level_at(9), "53733008", "T-11720"},    {level_at(10), "1626008", "T-11730"},
    {level_at(11), "73071006", "T-11740"},   {level_at(12), "56401006", "T-11750"},
    {level_at(13), "45296009", "T-11760"},   {level_at(14), "62487009", "T-11770"},
    {level_at(15), "11068009", "T-11780"},   {level_at(16), "82687006", "T-11790"},
    {level_at(17), "7610001", "T-117A0"},    {level_at(18), "12989004", "T-117B0"},
    {level_at(19), "23215003", "T-117C0"},   {level_at(20), "66794005", "T-11910"},
    {level_at(21), "14293000", "T-11920"},   {level_at(22), "36470004", "T-11930"},
    {level_at(23), "11994002", "T-11940"},   {level_at(24), "49668003", "T-11950"},
    {Level::kSacrum, "54735007", "T-11AD0"},
}};

constexpr std::string_view kFirstSacral = "65985001";  // as a name "S1" is: taken for the sacrum where it stands alone
constexpr std::string_view kVertebra = "51282000";
constexpr std::string_view kBone = "272673000";
constexpr std::string_view kRib = "113197003";

bool is_sct(const DicomCode& code) { return code.scheme == "SCT" || code.scheme == "2.16.840.1.113883.6.96"; }
bool is_srt(const DicomCode& code) { return code.scheme == "SRT" || code.scheme == "SNM3" || code.scheme == "99SDM"; }

}  // namespace

Level level_of_code(const DicomCode& code) {
  for (const LevelCode& known : kLevels) {
    if (is_sct(code) && code.value == known.sct) return known.level;
    if (is_srt(code) && code.value == known.srt) return known.level;
  }
  return is_sct(code) && code.value == kFirstSacral ? Level::kSacrum : Level::kNone;
}

bool is_any_bone_code(const DicomCode& code) {
  if (is_srt(code)) return code.value == "T-11510" || code.value == "T-D016E" || code.value == "T-10000";
  return is_sct(code) && (code.value == kVertebra || code.value == kBone || code.value == "3138006" ||
                          code.value == "90780006" || code.value == "421060004");
}

bool is_other_code(const DicomCode& code) {
  // Anatomical structure (two of them), tissue, organ.
  constexpr std::array<std::string_view, 8> kDefaults{"91723000", "123037004", "85756007", "113343008",
                                                      "T-D0005",  "T-D000A",   "T-D0050",  "T-D0060"};
  return (is_sct(code) || is_srt(code)) && !code.value.empty() && level_of_code(code) == Level::kNone &&
         !is_any_bone_code(code) && std::find(kDefaults.begin(), kDefaults.end(), code.value) == kDefaults.end();
}

DicomCode code_to_write(Level level, std::string_view name) {
  for (const LevelCode& known : kLevels) {
    if (known.level != level) continue;
    return {std::string(known.sct), "SCT", level == Level::kSacrum ? "Sacrum" : level_name(level) + " vertebra"};
  }
  if (level != Level::kNone) return {std::string(kVertebra), "SCT", "Vertebra"};
  const std::string lower = lower_case(name);
  if (lower.find("vertebra") != std::string::npos) return {std::string(kVertebra), "SCT", "Vertebra"};
  if (lower.find("rib") != std::string::npos) return {std::string(kRib), "SCT", "Rib"};
  return {std::string(kBone), "SCT", "Bone"};
}

}  // namespace spinaltap::detail
