#include "vdb/detail/vdb_layout.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iomanip>
#include <set>
#include <utility>

#include "core/base/error.h"
#include "core/base/hash.h"
#include "core/base/text_fields.h"
#include "core/base/text_writer.h"

// The format: OpenVDB 10.0's io/Archive.cc, io/Compression.h and tree/*Node.h.

namespace spinaltap::detail {
namespace {

constexpr std::int64_t kMagic = 0x56444220;
constexpr std::uint32_t kMinFormat = 222;
constexpr std::uint32_t kQuietFormat = 224;            ///< OpenVDB 10 warns of a newer one, on its own
constexpr std::uint32_t kMaxFormat = 225;              ///< OpenVDB 12's and 13's: 224, and grids of half floats
constexpr std::size_t kTagOffset = 8 + 4 + 4 + 4 + 1;  // magic, format, library's version, whether there are offsets
constexpr std::size_t kTagLength = 36;
constexpr std::string_view kSealMark = "5f1a17a9-";  ///< a sealed file's tag begins so
constexpr std::string_view kHalfSuffix = "_HalfFloat";
constexpr const char* kHalfKey = "is_saved_as_half_float";

/// Farther from the origin than any body, at any spacing: 2^22 voxels.
constexpr std::int32_t kMaxPlace = 1 << 22;
constexpr std::uint64_t kMaxTileVoxels = std::uint64_t{1} << 27;

class VdbCursor {
 public:
  VdbCursor(std::string& bytes, std::size_t at) : bytes_(&bytes), at_(at) {}

  std::size_t at() const { return at_; }
  std::size_t left() const { return bytes_->size() - at_; }

  char* take(std::size_t count) {
    if (count > left()) fail("cut short, or damaged at byte ", at_);
    char* taken = bytes_->data() + at_;
    at_ += count;
    return taken;
  }
  template <class Value>
  Value get() {
    Value value;
    std::memcpy(&value, take(sizeof value), sizeof value);
    return value;
  }
  std::string_view text() {
    const auto size = get<std::uint32_t>();
    return {take(size), size};
  }
  [[noreturn]] void reject(const char* what) const { fail("damaged before byte ", at_, ": ", what); }

 private:
  std::string* bytes_;
  std::size_t at_;
};

/// Sizes of the types that OpenVDB registers, without a look at what the file says of them.
struct MetadataSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr std::array<MetadataSize, 16> kMetadataSizes{{{"bool", 1},
                                                       {"double", 8},
                                                       {"float", 4},
                                                       {"int32", 4},
                                                       {"int64", 8},
                                                       {"vec2i", 8},
                                                       {"vec2s", 8},
                                                       {"vec2d", 16},
                                                       {"vec3i", 12},
                                                       {"vec3s", 12},
                                                       {"vec3d", 24},
                                                       {"vec4i", 16},
                                                       {"vec4s", 16},
                                                       {"vec4d", 32},
                                                       {"mat4s", 64},
                                                       {"mat4d", 128}}};

/// Returns whether floats are half ones, where they are a grid's.
bool check_metadata(VdbCursor& cursor) {
  bool is_half = false;
  for (auto left = cursor.get<std::uint32_t>(); left > 0; --left) {
    const std::string_view name = cursor.text();
    const auto type_size = cursor.get<std::uint32_t>();
    char* const type_begin = cursor.take(type_size);
    const std::string_view type(type_begin, type_size);
    const auto size = cursor.get<std::uint32_t>();
    const char* const value = cursor.take(size);
    const auto* known = std::find_if(kMetadataSizes.begin(), kMetadataSizes.end(),
                                     [&](const MetadataSize& one) { return one.type == type; });
    if (known != kMetadataSizes.end()) {
      if (size != known->bytes) cursor.reject("metadata of another size than their type's");
      if (type == "bool" && *value != 0 && *value != 1) cursor.reject("neither true nor false");
    } else if (type != "string" && type_size > 0) {
      *type_begin = '?';  // no type that is registered begins so
    }
    if (name == kHalfKey) {
      if (type != "bool") cursor.reject("expected to hear whether floats are half ones");
      is_half = *value != 0;
    }
  }
  return is_half;
}

bool is_about(double a, double b) { return std::abs(a - b) <= 1e-9 * std::abs(b); }

template <std::size_t kCount>
void check_numbers(VdbCursor& cursor) {
  constexpr double kMax = 1e12;
  for (const double number : cursor.get<std::array<double, kCount>>()) {
    if (!(std::abs(number) <= kMax)) cursor.reject("a transform that is none");
  }
}

/// A step along each axis, and what OpenVDB derives from it and keeps.
void check_scale(VdbCursor& cursor, bool is_uniform) {
  const auto kept = cursor.get<std::array<std::array<double, 3>, 5>>();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double step = kept[0][axis];
    if (!(std::abs(step) >= 1e-6 && std::abs(step) <= 1e6) || !is_about(kept[1][axis], std::abs(step)) ||
        !is_about(kept[2][axis], 1.0 / step) || !is_about(kept[3][axis], 1.0 / (step * step)) ||
        !is_about(kept[4][axis], 0.5 / step) || (is_uniform && step != kept[0][0])) {
      cursor.reject("a transform that is none");
    }
  }
}

void check_transform(VdbCursor& cursor) {
  const std::string_view map = cursor.text();
  if (map == "AffineMap" || map == "UnitaryMap") {
    check_numbers<16>(cursor);
  } else if (map == "TranslationMap") {
    check_numbers<3>(cursor);
  } else if (map == "ScaleMap" || map == "UniformScaleMap") {
    check_scale(cursor, map.starts_with("Uniform"));
  } else if (map == "ScaleTranslateMap" || map == "UniformScaleTranslateMap") {
    check_numbers<3>(cursor);
    check_scale(cursor, map.starts_with("Uniform"));
  } else {
    fail("expected a grid without perspective, found ", in_quotes(map));
  }
}

/// Bits of a node's mask in the file.
class VdbMask {
 public:
  VdbMask(VdbCursor& cursor, std::size_t slots) : bytes_(cursor.take(slots / 8)), words_(slots / 64) {}
  std::uint64_t word(std::size_t n) const {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes_ + 8 * n, sizeof word);
    return word;
  }
  std::size_t count() const {
    std::size_t count = 0;
    for (std::size_t n = 0; n < words_; ++n) count += static_cast<std::size_t>(std::popcount(word(n)));
    return count;
  }
  bool overlaps(const VdbMask& other) const {
    for (std::size_t n = 0; n < words_; ++n) {
      if ((word(n) & other.word(n)) != 0) return true;
    }
    return false;
  }
  bool operator==(const VdbMask& other) const { return std::memcmp(bytes_, other.bytes_, 8 * words_) == 0; }
  template <class Visit>
  void visit(const Visit& visit) const {
    for (std::size_t n = 0; n < words_; ++n) {
      for (std::uint64_t rest = word(n); rest != 0; rest &= rest - 1) {
        visit(64 * n + static_cast<std::size_t>(std::countr_zero(rest)));
      }
    }
  }

 private:
  const char* bytes_;
  std::size_t words_;
};

using VdbPlace = std::array<std::int32_t, 3>;

class TreeCheck {
 public:
  TreeCheck(VdbCursor& cursor, std::uint32_t compression, bool is_mask, bool is_half)
      : cursor_(cursor),
        compression_(compression),
        is_mask_(is_mask),
        value_bytes_(is_mask ? 1 : 4),
        is_half_(is_half && !is_mask) {}

  void run() {
    if (cursor_.get<std::int32_t>() != 1) cursor_.reject("a tree of several buffers");
    check_value();
    const auto tiles = cursor_.get<std::uint32_t>();
    const auto children = cursor_.get<std::uint32_t>();
    std::set<VdbPlace> tile_places;
    for (std::uint32_t n = 0; n < tiles; ++n) {
      if (!tile_places.insert(root_place()).second) cursor_.reject("two tiles in one place");
      check_value();
      if (cursor_.get<char>() != 0) cursor_.reject("an active tile of 4096 voxels a side");
    }
    for (std::uint32_t n = 0; n < children; ++n) {
      const VdbPlace place = root_place();
      // OpenVDB keeps them sorted, and reads the leaves' values in that order.
      if ((n > 0 && !(last_root_ < place)) || tile_places.contains(place)) cursor_.reject("nodes out of order");
      last_root_ = place;
      check_node<5>(place);
    }
    for (const Leaf& leaf : leaves_) check_leaf(leaf);
  }

 private:
  struct Leaf {
    VdbMask mask;
    VdbPlace place;
  };
  enum Compression : std::uint32_t { kZip = 1, kActiveMask = 2, kBlosc = 4 };

  void check_value() {
    const char* const value = cursor_.take(value_bytes_);
    if (is_mask_ && *value != 0 && *value != 1) cursor_.reject("neither true nor false");
  }

  VdbPlace root_place() {
    const auto place = cursor_.get<VdbPlace>();
    for (const std::int32_t number : place) {
      if (number % 4096 != 0 || number > kMaxPlace || number < -kMaxPlace) cursor_.reject("a node's place");
    }
    return place;
  }

  template <int kLog2>
  void check_node(const VdbPlace& place) {
    constexpr std::size_t kSlots = std::size_t{1} << (3 * kLog2);
    constexpr std::int32_t kChildSide = kLog2 == 5 ? 128 : 8;
    const VdbMask children(cursor_, kSlots);
    const VdbMask tiles(cursor_, kSlots);
    if (children.overlaps(tiles)) cursor_.reject("a tile where a node is");
    tile_voxels_ += tiles.count() * std::uint64_t{kChildSide} * kChildSide * kChildSide;
    if (tile_voxels_ > kMaxTileVoxels) fail("expected at most 2^27 voxels in active tiles, found more");
    check_values(kSlots, tiles);
    children.visit([&](std::size_t slot) {
      const std::size_t low = (std::size_t{1} << kLog2) - 1;
      const std::array<std::size_t, 3> steps{slot >> (2 * kLog2), (slot >> kLog2) & low, slot & low};
      VdbPlace child = place;
      for (std::size_t axis = 0; axis < 3; ++axis) child[axis] += kChildSide * static_cast<std::int32_t>(steps[axis]);
      if constexpr (kLog2 == 5) {
        check_node<4>(child);
      } else {
        leaves_.push_back({VdbMask(cursor_, kLeafSlots), child});
      }
    });
  }

  void check_leaf(const Leaf& leaf) {
    const VdbMask again(cursor_, kLeafSlots);
    if (!(again == leaf.mask)) cursor_.reject("a leaf's mask differs from itself");
    if (is_mask_) {
      if (cursor_.get<VdbPlace>() != leaf.place) cursor_.reject("a leaf's place");
    } else {
      check_values(kLeafSlots, again);
    }
  }

  /// As readCompressedValues() reads them.
  void check_values(std::size_t slots, const VdbMask& active) {
    enum : std::int8_t { kOneInactive = 2, kSelection = 3, kSelectionAndOne = 4, kSelectionAndTwo = 5, kAll = 6 };
    const auto kind = cursor_.get<std::int8_t>();
    if (kind < 0 || kind > kAll) cursor_.reject("values of an unknown kind");
    if (kind == kOneInactive || kind == kSelectionAndOne || kind == kSelectionAndTwo) check_value();
    if (kind == kSelectionAndTwo) check_value();
    if (kind == kSelection || kind == kSelectionAndOne || kind == kSelectionAndTwo) cursor_.take(slots / 8);
    const std::size_t count = (compression_ & kActiveMask) != 0 && kind != kAll ? active.count() : slots;
    if (is_half_ && count == 0) return;
    check_block(count * (is_half_ ? 2 : value_bytes_));
  }

  /// `bytes`: unpacked.
  void check_block(std::size_t bytes) {
    if ((compression_ & (kZip | kBlosc)) == 0) {
      cursor_.take(bytes);
      return;
    }
    const auto packed = cursor_.get<std::int64_t>();
    if (packed <= 0) {
      if (packed != -static_cast<std::int64_t>(bytes)) cursor_.reject("a block of another size than its values'");
      cursor_.take(bytes);
      return;
    }
    const char* const block = cursor_.take(static_cast<std::size_t>(packed));
    if ((compression_ & kBlosc) == 0) return;  // zlib is told both sizes
    constexpr std::int64_t kBloscHead = 16;
    std::array<std::uint32_t, 4> head{};
    if (packed >= kBloscHead) std::memcpy(head.data(), block, sizeof head);
    if (head[1] != bytes || head[3] != packed) cursor_.reject("a block of another size than its values'");
  }

  static constexpr std::size_t kLeafSlots = 512;
  VdbCursor& cursor_;
  std::uint32_t compression_;
  bool is_mask_;
  std::size_t value_bytes_;
  bool is_half_;
  VdbPlace last_root_{};
  std::uint64_t tile_voxels_ = 0;
  std::vector<Leaf> leaves_;
};

/// Returns where the grid ends.
std::size_t walk_grid(std::string& bytes, const VdbGrid& grid) {
  if (grid.type != kFloatGridType && grid.type != kMaskGridType) {
    fail("expected a grid of floats or a mask, found ", in_quotes(grid.type));
  }
  VdbCursor cursor(bytes, grid.begin);
  const auto compression = cursor.get<std::uint32_t>();
  if (compression > 7) cursor.reject("an unknown compression");
  const bool is_half = check_metadata(cursor);
  check_transform(cursor);
  if (grid.parent.empty()) TreeCheck(cursor, compression, grid.type == kMaskGridType, is_half).run();
  return cursor.at();
}

std::string seal_of(std::string_view bytes) {
  std::uint32_t crc = crc32_of(bytes.substr(0, kTagOffset));
  crc = crc32_of(bytes.substr(kTagOffset + kTagLength), crc);
  TextStream digits;
  digits << std::hex << std::setfill('0') << std::setw(8) << crc << std::setw(14) << bytes.size();
  const std::string d = digits.str();
  return std::string(kSealMark) + d.substr(0, 4) + "-8" + d.substr(4, 3) + "-8" + d.substr(7, 3) + "-" + d.substr(10);
}

VdbGrid read_descriptor(VdbCursor& cursor, bool has_offsets) {
  VdbGrid grid;
  grid.unique_name = cursor.text();
  grid.name = grid.unique_name.substr(0, grid.unique_name.find('\x1e'));  // OpenVDB's mark before a number
  grid.type = cursor.text();
  if (grid.type.ends_with(kHalfSuffix)) grid.type.resize(grid.type.size() - kHalfSuffix.size());
  grid.parent = cursor.text();
  // Where the leaves' values begin, between the two, is not written for a tree that is another grid's.
  const auto [begin, unused, end] = cursor.get<std::array<std::uint64_t, 3>>();
  grid.begin = cursor.at();
  if (!has_offsets) return grid;
  if (begin != cursor.at() || end < begin || end - begin > cursor.left()) {
    cursor.reject("a grid's place");
  }
  grid.end = end;
  return grid;
}

/// Floats and masks lie alike in all formats that are read.
void check_format(VdbCursor& cursor) {
  char* const place = cursor.take(sizeof(std::uint32_t));
  std::uint32_t format = 0;
  std::memcpy(&format, place, sizeof format);
  if (format < kMinFormat || format > kMaxFormat) {
    fail("expected a .vdb file of format ", kMinFormat, " to ", kMaxFormat, ", found ", format,
         format < kMinFormat ? ": save it with OpenVDB 2 or later"
                             : ": an OpenVDB newer than 13 wrote it; save it with 13 or an earlier one");
  }
  format = std::min(format, kQuietFormat);
  std::memcpy(place, &format, sizeof format);
}

}  // namespace

VdbLayout check_vdb(std::string& bytes) {
  VdbCursor cursor(bytes, 0);
  if (bytes.size() < kTagOffset + kTagLength || cursor.get<std::int64_t>() != kMagic) fail("this is no .vdb file");
  VdbLayout layout;
  const std::string_view tag = std::string_view(bytes).substr(kTagOffset, kTagLength);
  if (tag.starts_with(kSealMark)) {
    if (tag != seal_of(bytes)) fail("damaged or cut short: its checksum is another");
    layout.is_sealed = true;
  }
  check_format(cursor);
  cursor.take(2 * sizeof(std::uint32_t));
  const auto has_offsets = cursor.get<char>();
  if (has_offsets != 0 && has_offsets != 1) cursor.reject("neither true nor false");
  cursor.take(kTagLength);
  check_metadata(cursor);
  const auto count = cursor.get<std::int32_t>();
  if (count < 0) cursor.reject("a number of grids below 0");
  for (std::int32_t n = 0; n < count; ++n) {
    VdbGrid grid = read_descriptor(cursor, has_offsets != 0);
    if (has_offsets == 0) grid.end = walk_grid(bytes, grid);
    cursor = VdbCursor(bytes, grid.end);
    layout.grids.push_back(std::move(grid));
  }
  return layout;
}

void check_vdb_grid(std::string& bytes, const VdbGrid& grid) {
  const std::size_t end = walk_grid(bytes, grid);
  if (end != grid.end) fail("damaged: expected its end at byte ", grid.end, ", found it at ", end);
}

void seal_vdb(std::string& bytes) {
  if (bytes.size() < kTagOffset + kTagLength || VdbCursor(bytes, 0).get<std::int64_t>() != kMagic) {
    fail("expected the head of a file that OpenVDB 10 writes");
  }
  bytes.replace(kTagOffset, kTagLength, seal_of(bytes));
}

}  // namespace spinaltap::detail
