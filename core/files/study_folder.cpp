#include "core/files/study_folder.h"

#include <fcntl.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <climits>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/base/code_fingerprint.h"
#include "core/base/error.h"
#include "core/base/file_lock.h"
#include "core/base/hash.h"
#include "core/base/staged_output.h"
#include "core/base/text_fields.h"
#include "core/base/version.h"
#include "core/files/detail/placement_errors_json.h"
#include "core/files/detail/registration_json.h"
#include "core/files/detail/session_json.h"
#include "core/files/detail/study_json.h"
#include "core/files/detail/tool_json.h"
#include "core/files/json_file.h"

namespace spinaltap {
namespace {

constexpr FileFormat kFolderFormat{"spinaltap-study-folder", "folder of a study", "run the study in another folder"};
constexpr const char* kStudyFile = "study.json";
constexpr std::string_view kPartHead = "# runs of the study ";

std::string hash_of(std::string_view text) {
  WordHash64 hash;
  const std::uint64_t size = text.size();  // the last word is filled up: length tells "a" from "a\0"
  hash.add(&size, sizeof size);
  hash.add(text.data(), text.size());
  return hash.hex();
}

std::string head_of(const StudyIdentity& identity) { return std::string(kPartHead) + identity.hash() + "\n"; }

/// The row in a line of a part file, where its check is right.
bool read_line(std::string_view line, std::string_view& row) {
  const std::size_t comma = line.rfind(',');
  if (comma == std::string_view::npos) return false;
  row = line.substr(0, comma);
  return line.substr(comma + 1) == hash_of(row);
}

void check_head(std::string_view text, const StudyIdentity& identity, const std::filesystem::path& file) {
  if (text.starts_with(head_of(identity))) return;
  fail("expected runs of the study ", identity.hash(), " in ", file.string(), ", found ",
       text.starts_with(kPartHead) ? "those of another: take another folder, or the specification that it was made with"
                                   : "something else");
}

bool is_part(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("part-") && name.ends_with(".csv");
}

}  // namespace

std::string StudyIdentity::hash() const { return hash_of(study); }

void open_study_folder(const std::filesystem::path& folder, const StudyIdentity& identity) {
  const std::filesystem::path file = folder / kStudyFile;
  if (std::filesystem::exists(file)) {
    const StudyIdentity known = read_study_identity(folder);
    if (known.study == identity.study) return;
    const Json known_study = Json::parse(known.study);
    const Json study = Json::parse(identity.study);
    for (const auto& item : study.items()) {
      if (known_study.contains(item.key()) && known_study[item.key()] == item.value()) continue;
      fail("expected the same study as in ", folder.string(), ", found another ", in_quotes(item.key()),
           ": take another folder, or the specification that this one was made with");
    }
    fail("expected the same study as in ", folder.string(), ", found another: take another folder");
  }
  Json json = format_head(kFolderFormat);
  json.update(Json{{"hash", identity.hash()}, {"runs", identity.runs}, {"study", Json::parse(identity.study)}});
  write_json(json, file);
}

StudyIdentity read_study_identity(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / kStudyFile;
  if (!std::filesystem::exists(file))
    fail("expected a folder of a study, with ", kStudyFile, ", found ", folder.string());
  const Json json = read_json(file);
  const JsonObject object(json, file);
  check_format(json, kFolderFormat, file);
  StudyIdentity identity{object.at("study").dump(), object.whole_number("runs")};
  if (identity.hash() != object.text("hash")) fail("expected ", file.string(), " as it was written, found it changed");
  return identity;
}

void read_study_parts(const std::filesystem::path& folder, const StudyIdentity& identity, StudyRows& rows) {
  std::vector<std::filesystem::path> parts;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.is_regular_file() && is_part(entry.path())) parts.push_back(entry.path());
  }
  std::sort(parts.begin(), parts.end());
  for (const std::filesystem::path& part : parts) {
    const std::string text = read_whole_file(part);
    // Killed before its first line was whole: nothing is in it yet.
    if (text.find('\n') == std::string::npos) continue;
    check_head(text, identity, part);
    std::string_view left = std::string_view(text).substr(text.find('\n') + 1);
    for (std::size_t end = left.find('\n'); end != std::string_view::npos; end = left.find('\n')) {
      std::string_view row;
      if (read_line(left.substr(0, end), row)) {
        const std::size_t run = read_study_csv(row).run();
        if (run >= identity.runs) fail("expected runs below ", identity.runs, " in ", part.string(), ", found ", run);
        const auto [known, is_new] = rows.emplace(run, row);
        if (!is_new && known->second != row) fail("run ", run, " came out differently in ", part.string());
      }
      left.remove_prefix(end + 1);
    }
  }
}

StudyPart::StudyPart(const std::filesystem::path& folder, const std::string& name, const StudyIdentity& identity)
    : path_(folder / name) {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0) fail_as(ErrorKind::disk, "cannot open ", path_.string(), " to write");
  try {
    const FileLock lock = try_lock(file_, true);
    if (lock == FileLock::taken) {
      fail("another process works on ", path_.string(), ": wait for it, or take another shard");
    }
    if (lock == FileLock::failed) fail_as(ErrorKind::disk, "cannot lock ", path_.string(), ": ", std::strerror(errno));
    if (lock == FileLock::no_locking) open_unlocked();
    const std::string text = read_whole_file(path_);
    const std::size_t last_line = text.rfind('\n');
    const std::size_t whole = last_line == std::string::npos ? 0 : last_line + 1;
    if (whole > 0) check_head(text, identity, path_);
    if (whole < text.size() && ::ftruncate(file_, static_cast<off_t>(whole)) != 0) {
      fail_as(ErrorKind::disk, "cannot take the last row, which was cut short, off ", path_.string());
    }
    if (whole == 0) write(head_of(identity));
  } catch (...) {
    if (file_ >= 0) ::close(file_);
    throw;
  }
}

void StudyPart::open_unlocked() {
  is_locked_ = false;
  ::close(std::exchange(file_, -1));
  // What others may have in it stays as it is; an empty one that was only made to be locked says nothing.
  char host[HOST_NAME_MAX + 1] = {};
  if (::gethostname(host, HOST_NAME_MAX) != 0) host[0] = '\0';
  std::string writer(host);
  std::replace_if(
      writer.begin(), writer.end(), [](unsigned char c) { return std::isalnum(c) == 0 && c != '-'; }, '_');
  writer += "-" + std::to_string(::getpid());
  const std::filesystem::path shared = path_;
  constexpr int kMaxFiles = 10'000;  // of one process number on one computer, or in containers that share its name
  for (int n = 1; n <= kMaxFiles && file_ < 0; ++n) {
    path_ = shared.parent_path() / (shared.stem().string() + "." + writer + "-" + std::to_string(n) + ".csv");
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
    if (file_ < 0 && errno != EEXIST) break;
  }
  if (file_ < 0) fail_as(ErrorKind::disk, "cannot open ", path_.string(), " to write: ", std::strerror(errno));
}

StudyPart::~StudyPart() {
  ::fsync(file_);
  ::close(file_);
}

void StudyPart::append(const std::string& row) { write(row + "," + hash_of(row) + "\n"); }

void StudyPart::write(const std::string& text) {
  // One call a row: a kill comes before or after it, and other programs never read half of one.
  ssize_t written = 0;
  do {
    written = ::write(file_, text.data(), text.size());
  } while (written < 0 && errno == EINTR);
  if (written != static_cast<ssize_t>(text.size())) {
    fail_as(ErrorKind::disk, "cannot write ", path_.string(), ": the disk may be full; finished runs are kept");
  }
}

StudyIdentity study_identity(const StudySpec& spec, const StudyRuns& runs) {
  SessionSetup setup;
  setup.bone_hash = spec.bones.at(0).hash;
  setup.path = spec.bones.at(0).paths.at(0);
  setup.material = spec.material;
  setup.volume = spec.volume;
  setup.engine = spec.engine;
  setup.options = spec.options;
  Json bones = Json::array();
  for (const StudyBone& bone : spec.bones) {
    Json paths = Json::array();
    for (const DrillPath& path : bone.paths) paths.push_back(to_json(path));
    bones.push_back({{"hash", bone.hash},
                     {"level", level_name(bone.level)},
                     {"patient", bone.patient + 1},
                     {"paths", std::move(paths)}});
    if (bone.identity.names_ct()) bones.back()["ct"] = bone.identity.ct_hash;
    if (!bone.neighbours.empty()) bones.back()["neighbours"] = bone.neighbours;
  }
  Json study{{"program", version()},
             {"code", code_fingerprint(CodeStage::drilling)},
             {"name", spec.name},
             {"kind", name_of(spec.kind)},
             {"bones", std::move(bones)},
             {"session", to_json(setup)},
             {"lead_out_mm", spec.lead_out_mm},
             {"operator", to_json(spec.tool_operator)},
             {"design", to_json(spec.design)}};
  if (spec.errors) study["errors"] = to_json(*spec.errors);
  if (spec.registration) {
    study["registration"] = to_json(spec.registration->covariance);
    study["registration"]["per"] = name_of(spec.registration->per);
    if (!spec.registration->bone.is_empty()) study["registration"]["bone"] = to_json(spec.registration->bone);
  }
  if (spec.takes_other_ct) study["takes_other_ct"] = true;
  return {study.dump(), runs.count()};
}

IdentifiedStudy study_of(const StudyIdentity& identity, const std::filesystem::path& file) {
  const Json json = Json::parse(identity.study);
  const JsonObject object(json, file);
  IdentifiedStudy study;
  study.name = object.text("name");
  study.kind = read_study_kind(object, file);
  const Json& bones = object.at("bones");
  if (!bones.is_array() || bones.empty()) fail("expected bones in ", file.string(), ", found none");
  for (const Json& item : bones) {
    const JsonObject of(item, file);
    StudyBone bone;
    bone.hash = of.text("hash");
    bone.level = level_from_name(of.text("level")).value_or(Level::kNone);
    bone.identity = {of.has("ct") ? of.text("ct") : "", bone.level};
    bone.patient = checked_patient(of.whole_number("patient"), file);
    const Json& paths = of.at("paths");
    if (!paths.is_array() || paths.empty()) fail("expected paths of each bone in ", file.string(), ", found none");
    for (const Json& path : paths) bone.paths.push_back(read_path(path, file));
    study.bones.push_back(std::move(bone));
  }
  study.setup = read_session_setup(object.at("session"), file);
  study.tool_operator = read_study_operator(object.at("operator"), file);
  study.design = read_study_design(object.at("design"), file);
  if (object.has("errors")) study.errors = placement_errors_in(object.at("errors"), file);
  if (object.has("registration")) {
    study.registration = read_drawn_per(JsonObject(object.at("registration"), file), file);
  }
  return study;
}

}  // namespace spinaltap
