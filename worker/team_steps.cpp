#include "worker/team_steps.h"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/log.h"

namespace skyquilt::worker {
namespace {

// Steps that warm caches up, and steps that are timed.
constexpr int kWarm = 16, kTimed = 32;

}  // namespace

TeamSteps::TeamSteps(const Team& team) : team_(team) {
  share_.members = team.members;
  share_.number = team.number;
  share_.exchange = [this](std::string own) { return Exchange(std::move(own)); };
}

bool TeamSteps::TimeToSummon(double step_seconds) {
  if (team_.members < 2 || !leads() || tried_) return false;
  if (++alone_steps_ > kWarm) alone_s_ += step_seconds;
  return alone_steps_ == kWarm + kTimed;
}

void TeamSteps::Begin(double fraction) {
  tried_ = together_ = true;
  own_.fraction = fraction;
  Exchange("");
}

const StepShare& TeamSteps::share() {
  return share_;
}

void TeamSteps::Announce(double next_fraction, bool stop) {
  own_.fraction = next_fraction;
  own_.stop = stop ? 1 : 0;
}

std::vector<std::string> TeamSteps::Exchange(std::string own) {
  if (base::CancelRequested()) own_.stop = 1;
  own.append(reinterpret_cast<const char*>(&own_.fraction), sizeof own_.fraction);
  own.push_back(static_cast<char>(own_.stop));
  own.push_back(static_cast<char>(own_.home));
  constexpr size_t kWordBytes = sizeof(double) + 2;
  std::vector<std::string> all = team_.exchange(std::move(own));
  heard_.stop = 0;
  for (size_t number = 0; number < all.size(); ++number) {
    std::string& bytes = all[number];
    if (bytes.size() < kWordBytes) throw std::runtime_error("a member of the team says nothing: do all ranks run the same program?");
    const char* word = bytes.data() + bytes.size() - kWordBytes;
    if (number == 0) {
      std::memcpy(&heard_.fraction, word, sizeof heard_.fraction);
      heard_.home = static_cast<uint8_t>(word[sizeof(double) + 1]);
    }
    heard_.stop |= static_cast<uint8_t>(word[sizeof(double)]);
    bytes.resize(bytes.size() - kWordBytes);
  }
  return all;
}

bool TeamSteps::GoesHome(double step_seconds) {
  if (heard_.home != 0) {
    together_ = false;
    return true;
  }
  if (!leads() || own_.home != 0) return false;
  if (++shared_steps_ > kWarm) shared_s_ += step_seconds;
  if (shared_steps_ != kWarm + kTimed) return false;
  const double ratio = shared_s_ / alone_s_;
  own_.home = ratio > team_.worth_it ? 1 : 0;
  spdlog::info("context: a step shared by {} ranks takes {:.2f} of the time that it takes alone: {}", team_.members, ratio,
               own_.home != 0 ? "going on alone" : "going on together");
  return false;
}

}  // namespace skyquilt::worker
