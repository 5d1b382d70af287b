// How members of a team go through their steps together: who leads says how far the training is and when it ends, and sends the others home when they
// do not make it faster.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "worker/step_share.h"
#include "worker/trainer.h"

namespace skyquilt::worker {

class TeamSteps {
 public:
  explicit TeamSteps(const Team& team);

  // Whether steps are shared now.
  bool together() const { return together_; }
  bool leads() const { return team_.number == 0; }
  // Of the leader, after each step of its own: whether it is time to save and to summon the others, who take part from the next step on.
  bool TimeToSummon(double step_seconds);
  // All members, before the first shared step; `fraction` as the leader has it.
  void Begin(double fraction);
  // For FieldTrainer::Step; only when together.
  const StepShare& share();
  // What the leader says goes along with the next step's exchange: the fraction of the budget after it, and whether all stop then.
  void Announce(double next_fraction, bool stop);
  // After a shared step: what was announced with it. Somebody who was asked to stop stops all.
  double fraction() const { return heard_.fraction; }
  bool stop() const { return heard_.stop != 0; }
  // After a shared step of this length. True when the others go home; of a member that is one of them, its work is done.
  bool GoesHome(double step_seconds);

 private:
  struct Word {
    double fraction = 0.0;
    uint8_t stop = 0;
    uint8_t home = 0;
  };
  std::vector<std::string> Exchange(std::string own);

  const Team& team_;
  StepShare share_;
  bool together_ = false;
  bool tried_ = false;  // the others have been here
  Word own_, heard_;
  int alone_steps_ = 0, shared_steps_ = 0;
  double alone_s_ = 0.0, shared_s_ = 0.0;
};

}  // namespace skyquilt::worker
