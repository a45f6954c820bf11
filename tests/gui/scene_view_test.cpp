#include "apps/planner/scene/scene_view.h"

#include <gmock/gmock.h>

namespace spinaltap {
namespace {
}  // namespace
}  // namespace spinaltap
