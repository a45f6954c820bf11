#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/session/session_setup.h"
#include "core/study/study_row.h"
#include "core/study/study_shard.h"
#include "core/study/study_spec.h"

namespace spinaltap {

/// Makes the folder, or finds it, and writes study.json where there is none. Throws Error where it holds another study.
void open_study_folder(const std::filesystem::path& folder, const StudyIdentity& identity);
/// Reads study.json. Throws Error where there is none.
StudyIdentity read_study_identity(const std::filesystem::path& folder);

/// Adds all whole rows of the folder's part files to `rows`. A row that was cut short or damaged is passed over: its
/// run is run again. Throws Error on parts of another study, and on two rows of one run that differ.
void read_study_parts(const std::filesystem::path& folder, const StudyIdentity& identity, StudyRows& rows);

/// Appends finished runs to a part file, each whole and with a check, so that a kill at any moment costs no finished
/// run.
class StudyPart {
 public:
  /// `name`: of the file. Takes off a last row that was cut short. Throws Error where the file is another study's, and
  /// where another process writes to it. On a file system without locks that cannot be known: rows then go to a new
  /// file, whose name has this computer's and process's too, so that no two processes write to one. Two of them may do
  /// one run twice, and its rows are the same.
  StudyPart(const std::filesystem::path& folder, const std::string& name, const StudyIdentity& identity);
  ~StudyPart();
  StudyPart(const StudyPart&) = delete;
  StudyPart& operator=(const StudyPart&) = delete;

  /// One thread at a time. Throws Error when the disk is full; rows before stay.
  void append(const std::string& row);

  const std::filesystem::path& path() const { return path_; }
  /// False where the file system has no locks.
  bool is_locked() const { return is_locked_; }

 private:
  void open_unlocked();
  void write(const std::string& text);

  std::filesystem::path path_;
  int file_ = -1;
  bool is_locked_ = true;
};

/// What a study's results depend on. Its bones' paths and fingerprints and, where it drills, `spec.volume.radius_mm`
/// must be known by now.
StudyIdentity study_identity(const StudySpec& spec, const StudyRuns& runs);

/// What an identity says of its study.
struct IdentifiedStudy {
  std::string name;
  StudyKind kind = StudyKind::drilling;
  std::vector<StudyBone> bones;  ///< without files and frames
  SessionSetup setup;            ///< of the first path
  StudyOperator tool_operator;
  StudyDesign design;
  std::optional<PlacementErrors> errors;
  std::optional<DrawnPer> registration;  ///< for what it is drawn anew; nothing where there is none

  /// What its runs are shared out to.
  StudyGround ground() const { return ground_of(bones, errors.has_value(), registration); }
};

/// Reads what study_identity() made. Throws Error that names `file` and the key at fault.
IdentifiedStudy study_of(const StudyIdentity& identity, const std::filesystem::path& file);

}  // namespace spinaltap
