#pragma once

#include "core/files/json_file.h"
#include "core/registration/pose_covariance.h"

namespace spinaltap {

/// The covariance of a pose, as registrations and studies have it.
Json to_json(const PoseCovariance& covariance);

}  // namespace spinaltap
