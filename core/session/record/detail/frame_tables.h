#pragma once

#include <array>
#include <optional>

#include "core/base/hdf5_file.h"
#include "core/session/record/session_record.h"

namespace spinaltap {

/// What `/frames` holds for sure, and what its frames are like: written, in one piece, after all that it counts.
struct FrameProgress {
  static constexpr std::uint64_t kNumbers = 5;

  std::uint64_t frames = 0;
  FrameFormat format;

  std::array<std::uint64_t, kNumbers> numbers() const;
  /// Throws Error where the numbers are damaged.
  static FrameProgress of(const std::array<std::uint64_t, kNumbers>& numbers, const std::filesystem::path& path);
};

/// The tables of `/frames`; docs/record-file.md.
class FrameTables {
 public:
  /// Of a file that is being written.
  static FrameTables make(Hdf5File& file, const FrameFormat& format);
  /// Of one that is read; nothing where it has no frames.
  static std::optional<FrameTables> open(const Hdf5File& file, const std::filesystem::path& path);

  const FrameFormat& format() const { return progress_.format; }
  /// Written, or there for sure.
  std::uint64_t count() const { return progress_.frames; }
  std::uint64_t frame_bytes() const;

  void write(const RecordedFrame& frame);
  /// Says how many there are, which must have gone out before.
  void say_progress();
  RecordedFrame read(std::uint64_t row, const std::filesystem::path& path) const;

 private:
  explicit FrameTables(const FrameProgress& progress) : progress_(progress) {}
  template <class Table>
  void for_each_table(const Table& table);

  FrameProgress progress_;
  Hdf5Table progress_row_, cycle_, time_, matrix_, pose_, depth_, normals_, mask_;
};

}  // namespace spinaltap
