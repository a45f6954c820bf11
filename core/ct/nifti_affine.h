#pragma once

namespace spinaltap {

/// Which of a NIfTI file's two transforms says where its voxels lie.
enum class NiftiAffine {
  automatic,  ///< the one that is sure; an error where neither is
  sform,
  qform,
};

}  // namespace spinaltap
