#pragma once

#include <array>

#include "core/segment/segment_spine.h"

namespace spinaltap::test {

/// What doubt of a level may be learned from, by name. Sizes stand in proportion to the body's, so that they mean the
/// same from the neck to L5.
inline constexpr std::array<const char*, 24> kDoubtFigures{
    "voxel_mm",        ///< the CT's largest step
    "noise_hu",        ///< of the CT
    "sure_hu",         ///< the CT's sure level of bone over its threshold, HU
    "faint_wall",      ///< what the body's wall lacks of a full one
    "is_cut",          ///< the CT cuts the body
    "high",            ///< logarithm of the body's height over its depth
    "unlike_high",     ///< of its height over a neighbour's, the nearer one's, without sign
    "unlike_wide",     ///< the same of widths
    "unlike_deep",     ///< the same of depths
    "is_last",         ///< no level lies above, or none below
    "unsure",          ///< share of its bone where the walker hardly preferred it
    "joints",          ///< area of cuts through joints and ribs, over the area of its endplate
    "fused",           ///< the same of cuts through its endplates and beside its body
    "uneven",          ///< of its volume's share at either side of the middle plane, half of the difference
    "uneven_reach",    ///< of its reach to both sides, the difference over its width
    "lopsided",        ///< the largest piece without its like on the other side, over the body's volume
    "thin_pedicle",    ///< section of its thinner pedicle over its endplate
    "open_ring",       ///< share of the way around the canal that it leaves open
    "short_spinous",   ///< reach behind the canal's middle over its depth
    "volume",          ///< logarithm of its volume over its body's
    "dark_inside",     ///< how far its surface's voxels lie over the threshold, HU
    "bright_outside",  ///< how far what lies beyond them is under it, HU
    "light_bone",      ///< how far the middle of its body lies over the threshold, HU
    "rules",           ///< the severity by the rules
};
using DoubtFigures = std::array<double, kDoubtFigures.size()>;

/// The figures of one of the levels that were found in a CT.
DoubtFigures doubt_figures(const CtVolume& ct, const SpineSegmentation& found, std::size_t index);

}  // namespace spinaltap::test
