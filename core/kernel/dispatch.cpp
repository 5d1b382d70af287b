#include <hwy/targets.h>

#include <stdexcept>

#include "core/base/text.h"
#include "core/kernel/kernels.h"

namespace skyquilt::kernel {
namespace {

// The common name of one of Highway's instruction sets.
std::string CommonName(int64_t target) {
  if (target <= HWY_AVX3) return "avx512";
  if (target == HWY_AVX2) return "avx2";
  return base::LowerCase(hwy::TargetName(target));
}

// Instruction sets that the program was built for and this processor has, best first. Read once, before one is forced: afterwards Highway reports
// only the forced one.
const std::vector<int64_t>& UsableTargets() {
  static const std::vector<int64_t> usable = [] {
    std::vector<int64_t> found;
    for (int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) found.push_back(rest & -rest);
    return found;
  }();
  return usable;
}

}  // namespace

std::string ActiveInstructionSet() {
  const int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  return base::LowerCase(hwy::TargetName(usable & -usable));
}

std::vector<std::string> InstructionSets() {
  std::vector<std::string> names;
  for (const int64_t target : UsableTargets()) names.push_back(base::LowerCase(hwy::TargetName(target)));
  return names;
}

void ForceInstructionSet(const std::string& name) {
  const std::vector<int64_t>& usable = UsableTargets();
  std::string known;
  for (const int64_t target : usable) {
    const std::string own = base::LowerCase(hwy::TargetName(target));
    const bool portable = name == "portable" && target == usable.back();
    if (name == own || name == CommonName(target) || portable) {
      // Highway chooses the lowest set bit, which is then this target.
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(target);
      return;
    }
    known += (known.empty() ? "" : ", ") + own;
  }
  throw std::invalid_argument("instruction set '" + name + "' is not available on this processor; choose one of " + known +
                              ", or avx512, avx2, portable");
}

}  // namespace skyquilt::kernel
