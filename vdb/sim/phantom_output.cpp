#include "vdb/sim/phantom_output.h"

#include "core/base/error.h"
#include "core/base/staged_output.h"
#include "core/ct/dicom_write.h"
#include "core/files/data_files.h"
#include "core/files/ground_truth_file.h"
#include "core/files/phantom_file.h"
#include "core/files/plan_file.h"
#include "core/phantom/spine_ground_truth.h"
#include "core/phantom/true_labels.h"
#include "core/phantom/vertebra.h"
#include "vdb/bake/bake.h"
#include "vdb/sim/bone_identity.h"

namespace spinaltap {
namespace {

void write_ct(const CtVolume& ct, double slice_width_mm, const std::filesystem::path& folder,
              const Progress& progress) {
  std::error_code error;
  std::filesystem::create_directory(folder, error);
  if (error) fail_as(ErrorKind::disk, "cannot make the folder ", folder.string(), ": ", error.message());
  write_dicom(ct, folder, {.series_description = "SpinalTap virtual scan", .slice_thickness_mm = slice_width_mm},
              progress);
}

std::vector<DrillPath> pedicle_paths(const VertebraGroundTruth& ground_truth, const std::string& ct_hash) {
  const auto path = [&](const char* name, const PedicleGroundTruth& pedicle) {
    DrillPath planned{name, pedicle.entry_mm, pedicle.target_mm, DrillBit()};
    planned.bone.ct_hash = ct_hash;
    return planned;
  };
  return {path("left", ground_truth.left), path("right", ground_truth.right)};
}

}  // namespace

PhantomBone phantom_bone(double voxel_mm, const Progress& progress) {
  const Vertebra vertebra(read_anatomy(data_file("phantom/l3.json")));
  return {Bone(bake_solid(vertebra, {.voxel_mm = voxel_mm}, ScanOptions().surroundings_hu, progress)),
          pedicle_paths(vertebra_ground_truth(vertebra), "")};
}

void write_spine_phantom(const Spine& spine, const Surroundings* surroundings, const ScanOptions& options,
                         const std::filesystem::path& folder, const Progress& progress) {
  StagedFolder staged(folder, "ground_truth.json");
  const CtVolume ct =
      surroundings != nullptr ? scan(spine, *surroundings, options, progress) : scan(spine, options, progress);
  write_ct(ct, options.slice_width_mm, staged.temporary() / "ct", progress);
  const std::filesystem::path labels = staged.temporary() / "ground_truth_labels.nii.gz";
  write_whole_file(labels, encode_label_volume(true_labels(spine, ct.geometry), labels));
  write_ground_truth(spine_ground_truth(spine), options, ct.source_hash, staged.temporary() / "ground_truth.json");
  staged.commit();
}

void write_phantom(const Solid& solid, const std::optional<VertebraGroundTruth>& ground_truth,
                   const PhantomOptions& options, const std::filesystem::path& folder, const Progress& progress) {
  StagedFolder staged(folder, "ground_truth.json");
  const CtVolume ct = scan(solid, options.scan, progress);
  write_ct(ct, options.scan.slice_width_mm, staged.temporary() / "ct", progress);
  write_bone(bake_solid(solid, {.voxel_mm = options.ground_truth_voxel_mm}, options.scan.surroundings_hu, progress,
                        {{kWholeCtHash, ct.whole_hash}}),
             staged.temporary() / "ground_truth.vdb");
  write_ground_truth(ground_truth, options.scan, ct.source_hash, staged.temporary() / "ground_truth.json");
  if (ground_truth) write_plan(pedicle_paths(*ground_truth, ct.whole_hash), staged.temporary() / "plan.json");
  staged.commit();
}

}  // namespace spinaltap
