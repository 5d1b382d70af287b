// The part of a training step that one of several trainers does. All of them have the same field, bit for bit, and draw the same rays; each works on
// some of the packets, and what comes of those is passed on to everybody before the parameters are changed. Sums are taken in the order in which one
// alone takes them, so the bits are those of one alone.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace skyquilt::worker {

struct StepShare {
  int members = 1;
  int number = 0;
  // Everybody's bytes, by number; all members call it once per step.
  std::function<std::vector<std::string>(std::string own)> exchange;

  bool Mine(size_t slot) const { return slot % static_cast<size_t>(members) == static_cast<size_t>(number); }
};

}  // namespace skyquilt::worker
