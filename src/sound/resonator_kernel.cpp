// Compiled once for each instruction set: foreach_target.h includes this file again.
#include "sound/resonator_kernel.h"

#include <algorithm>
#include <array>
#include <cassert>

// Scalable vectors (SVE, RVV) cannot be array elements.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sound/resonator_kernel.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace intaglio::sound {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, resonator_lanes>;
using V = hn::Vec<Tag>;
constexpr Tag tag;
constexpr int width = int(hn::MaxLanes(tag));
constexpr int parts = resonator_lanes / width;  // vectors per group
// Groups interleaved to hide the latency of the recurrence.
constexpr int together = width >= 16 ? 4 : width == 8 ? 2 : 1;

// The input of a group from several drives, sample by sample.
struct GroupInput {
  alignas(64) std::array<float, block_samples * resonator_lanes> re, im;
};

HWY_ATTR inline void AccumulateDrives(const ResonatorGroup& group, int index, std::span<const Drive> drives,
                                      int samples, GroupInput& in) {
  std::fill_n(in.re.begin(), samples * resonator_lanes, 0.0f);
  std::fill_n(in.im.begin(), samples * resonator_lanes, 0.0f);
  for (const Drive& drive : drives) {
    for (int lane = 0; lane < resonator_lanes; lane += width) {
      const V gain = hn::LoadU(tag, drive.gains.data() + index * resonator_lanes + lane);
      const V gain_re = hn::Mul(hn::Load(tag, group.drive_re + lane), gain);
      const V gain_im = hn::Mul(hn::Load(tag, group.drive_im + lane), gain);
      for (std::size_t k = 0; k < drive.impulse.size(); ++k) {
        const std::size_t at = (std::size_t(drive.first) + k) * resonator_lanes + std::size_t(lane);
        const V impulse = hn::Set(tag, drive.impulse[k]);
        hn::Store(hn::Add(hn::Load(tag, &in.re[at]), hn::Mul(gain_re, impulse)), tag, &in.re[at]);
        hn::Store(hn::Add(hn::Load(tag, &in.im[at]), hn::Mul(gain_im, impulse)), tag, &in.im[at]);
      }
    }
  }
}

HWY_ATTR inline void RingWithInput(ResonatorGroup& group, const GroupInput& in, int samples, float* sum) {
  for (int lane = 0; lane < resonator_lanes; lane += width) {
    const V turn_re = hn::Load(tag, group.turn_re + lane), turn_im = hn::Load(tag, group.turn_im + lane);
    V re = hn::Load(tag, group.re + lane), im = hn::Load(tag, group.im + lane);
    for (int n = 0; n < samples; ++n) {
      const int at = n * resonator_lanes + lane;
      const V before = re;
      re = hn::Add(hn::Sub(hn::Mul(turn_re, re), hn::Mul(turn_im, im)),
                   hn::Load(tag, &in.re[std::size_t(at)]));
      im = hn::Add(hn::Add(hn::Mul(turn_re, im), hn::Mul(turn_im, before)),
                   hn::Load(tag, &in.im[std::size_t(at)]));
      hn::Store(hn::Add(hn::Load(tag, sum + at), re), tag, sum + at);
    }
    hn::Store(re, tag, group.re + lane);
    hn::Store(im, tag, group.im + lane);
  }
}

// `count` groups at once, driven by one impulse or by none.
template <int count, bool is_driven>
HWY_ATTR inline void RingTogether(ResonatorGroup* groups, const int* index, const float* gains,
                                  const float* impulse, int samples, float* sum) {
  V re[count][parts], im[count][parts], turn_re[count][parts], turn_im[count][parts];
  V gain_re[count][parts], gain_im[count][parts];
  for (int g = 0; g < count; ++g) {
    const ResonatorGroup& group = groups[index[g]];
    for (int p = 0; p < parts; ++p) {
      re[g][p] = hn::Load(tag, group.re + p * width);
      im[g][p] = hn::Load(tag, group.im + p * width);
      turn_re[g][p] = hn::Load(tag, group.turn_re + p * width);
      turn_im[g][p] = hn::Load(tag, group.turn_im + p * width);
      if constexpr (is_driven) {
        const V gain = hn::LoadU(tag, gains + index[g] * resonator_lanes + p * width);
        gain_re[g][p] = hn::Mul(hn::Load(tag, group.drive_re + p * width), gain);
        gain_im[g][p] = hn::Mul(hn::Load(tag, group.drive_im + p * width), gain);
      }
    }
  }
  for (int n = 0; n < samples; ++n) {
    V input;
    if constexpr (is_driven) input = hn::Set(tag, impulse[n]);
    for (int p = 0; p < parts; ++p) {
      float* const at = sum + n * resonator_lanes + p * width;
      V total = hn::Load(tag, at);
      for (int g = 0; g < count; ++g) {
        const V before = re[g][p];
        re[g][p] = hn::Sub(hn::Mul(turn_re[g][p], before), hn::Mul(turn_im[g][p], im[g][p]));
        im[g][p] = hn::Add(hn::Mul(turn_re[g][p], im[g][p]), hn::Mul(turn_im[g][p], before));
        if constexpr (is_driven) {
          re[g][p] = hn::Add(re[g][p], hn::Mul(gain_re[g][p], input));
          im[g][p] = hn::Add(im[g][p], hn::Mul(gain_im[g][p], input));
        }
        total = hn::Add(total, re[g][p]);
      }
      hn::Store(total, tag, at);
    }
  }
  for (int g = 0; g < count; ++g) {
    ResonatorGroup& group = groups[index[g]];
    for (int p = 0; p < parts; ++p) {
      hn::Store(re[g][p], tag, group.re + p * width);
      hn::Store(im[g][p], tag, group.im + p * width);
    }
  }
}

// All groups, `count` at a time, then fewer.
template <bool is_driven, int count = together>
HWY_ATTR inline void RingAll(ResonatorGroup* groups, std::span<const int> awake, const float* gains,
                             const float* impulse, int samples, float* sum) {
  while (awake.size() >= count) {
    RingTogether<count, is_driven>(groups, awake.data(), gains, impulse, samples, sum);
    awake = awake.subspan(count);
  }
  if constexpr (count > 1) RingAll<is_driven, count - 1>(groups, awake, gains, impulse, samples, sum);
}

HWY_ATTR void Ring(std::span<ResonatorGroup> groups, std::span<const int> awake,
                   std::span<const Drive> drives, int samples, float* sum) {
  if (drives.empty()) {
    RingAll<false>(groups.data(), awake, nullptr, nullptr, samples, sum);
  } else if (drives.size() == 1) {
    std::array<float, block_samples> impulse{};
    std::copy(drives[0].impulse.begin(), drives[0].impulse.end(), impulse.begin() + drives[0].first);
    RingAll<true>(groups.data(), awake, drives[0].gains.data(), impulse.data(), samples, sum);
  } else {
    GroupInput in;
    for (const int k : awake) {
      AccumulateDrives(groups[std::size_t(k)], k, drives, samples, in);
      RingWithInput(groups[std::size_t(k)], in, samples, sum);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace intaglio::sound
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace intaglio::sound {

HWY_EXPORT(Ring);

void ring(std::span<ResonatorGroup> groups, std::span<const int> awake, std::span<const Drive> drives,
          int samples, float* sum) {
  assert(samples <= block_samples);
  HWY_DYNAMIC_DISPATCH(Ring)(groups, awake, drives, samples, sum);
}

std::vector<std::string> ring_targets() {
  std::vector<std::string> names;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    names.push_back(hwy::TargetName(target));
  return names;
}

void use_ring_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (hwy::TargetName(target) == name) hwy::SetSupportedTargetsForTest(target);
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

void use_best_ring_target() {
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace intaglio::sound
#endif
