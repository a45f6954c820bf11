#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>

#include <cctype>
#include <fstream>

#include "core/base/error.h"
#include "core/base/hash.h"
#include "vdb/bone_model.h"
#include "vdb/detail/bone_grids.h"
#include "vdb/initialize.h"

namespace spinaltap {
namespace {

constexpr const char* kFactPrefix = "spinaltap:";

/// OpenVDB puts a random tag into each file's head. One made from the content keeps equal models' files equal.
void replace_random_tag(const std::filesystem::path& path, const std::string& digits) {
  constexpr std::streamoff kTagOffset = 8 + 4 + 4 + 4 + 1;  // magic, file version, library version, has-offsets
  constexpr std::size_t kTagLength = 36;
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  std::string tag(kTagLength, ' ');
  file.seekg(kTagOffset);
  file.read(tag.data(), kTagLength);
  for (std::size_t i = 0, digit = 0; i < kTagLength; ++i) {
    const bool dash = i == 8 || i == 13 || i == 18 || i == 23;
    if (!file || (tag[i] == '-') != dash || (!dash && std::isxdigit(static_cast<unsigned char>(tag[i])) == 0)) {
      fail("cannot write ", path.string(), ": not the file head that OpenVDB 10 writes");
    }
    if (!dash) tag[i] = digits[digit++ % digits.size()];
  }
  file.seekp(kTagOffset);
  file.write(tag.data(), kTagLength);
  file.close();
  if (!file) fail("cannot write ", path.string());
}

/// The start of a message that may quote a damaged file's bytes.
std::string printable(const std::string& message) {
  constexpr std::size_t kMost = 160;
  std::string text;
  for (const char c : message.substr(0, kMost)) text += c >= ' ' && c <= '~' ? c : '?';
  return text;
}

std::string hash_of(const BoneModel& bone) {
  Fnv1a hash;
  for (const auto& grid : {bone.grids().sdf, bone.grids().hu}) {
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
      hash.add(leaf->origin().data(), 3 * sizeof(openvdb::Int32));
      hash.add(leaf->buffer().data(), openvdb::FloatTree::LeafNodeType::SIZE * sizeof(float));
    }
  }
  return hash.hex();
}

}  // namespace

void write_bone(const BoneModel& bone, const std::filesystem::path& path) {
  initialize_openvdb();
  const auto sdf = bone.grids().sdf->deepCopy();
  const auto hu = bone.grids().hu->deepCopy();
  sdf->setName("sdf");
  sdf->setGridClass(openvdb::GRID_LEVEL_SET);
  hu->setName("hu");
  // CT numbers were rounded to half floats when they were baked, so this loses nothing.
  hu->setSaveFloatAsHalf(true);
  for (const auto& [key, value] : bone.facts()) {
    sdf->insertMeta(kFactPrefix + key, openvdb::StringMetadata(value));
  }
  try {
    openvdb::io::File file(path.string());
    file.write(openvdb::GridCPtrVec{sdf, hu});
    file.close();
    replace_random_tag(path, hash_of(bone));
    // OpenVDB does not look whether its last bytes reached the disk; reading them back does.
    read_bone(path);
  } catch (const std::exception&) {
    // What OpenVDB says of its own broken file does not help; the cause is nearly always this one.
    fail("cannot write ", path.filename().string(), ": is the disk full, or the folder not writable?");
  }
}

BoneModel read_bone(const std::filesystem::path& path) {
  initialize_openvdb();
  std::error_code status;
  if (!std::filesystem::exists(path, status)) fail("no such file: ", path.string());
  if (!std::filesystem::is_regular_file(path, status)) {
    fail("expected a .vdb file, found something else: ", path.string());
  }
  auto grids = std::make_shared<detail::BoneGrids>();
  try {
    // OpenVDB does not look whether it got the bytes that it asked for. This stream throws when they run out, so that a
    // file cut short is noticed, even by one byte, before garbage is taken for sizes.
    std::ifstream bytes;
    bytes.exceptions(std::ios::failbit | std::ios::badbit);
    bytes.open(path, std::ios::binary);
    openvdb::io::Stream stream(bytes, false);
    const openvdb::GridPtrVecPtr found = stream.getGrids();
    const auto grid = [&](const char* name) {
      const auto at = openvdb::findGridByName(*found, name);
      if (!at) fail("expected the grids sdf and hu in ", path.string(), ", found no ", name);
      return openvdb::gridPtrCast<openvdb::FloatGrid>(at);
    };
    grids->sdf = grid("sdf");
    grids->hu = grid("hu");
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    fail("cannot read ", path.string(), ": ", printable(error.what()));
  }
  if (!grids->sdf || !grids->hu) fail("expected grids of floats in ", path.string());
  if (grids->sdf->getGridClass() != openvdb::GRID_LEVEL_SET || grids->sdf->activeVoxelCount() == 0) {
    fail("expected the grid sdf to be a level set that is not empty in ", path.string());
  }
  if (!grids->sdf->transform().isLinear() || !grids->sdf->hasUniformVoxels() || !grids->hu->transform().isLinear()) {
    fail("expected the grid sdf to have cubic voxels, and no perspective, in ", path.string());
  }
  const std::string prefix = kFactPrefix;
  for (auto meta = grids->sdf->beginMeta(); meta != grids->sdf->endMeta(); ++meta) {
    if (meta->first.rfind(prefix, 0) == 0) grids->facts[meta->first.substr(prefix.size())] = meta->second->str();
  }
  return BoneModel(grids);
}

}  // namespace spinaltap
