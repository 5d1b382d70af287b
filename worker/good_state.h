// The last good state of a training, kept in memory: what it goes back to when it falls apart, and what is written to its checkpoint. A checkpoint
// of any other state could hold a fall that nobody has noticed yet, and a resumed training would have nothing to go back to.
#pragma once

#include <functional>

#include "worker/block_session.h"

namespace skyquilt::worker {

class GoodState {
 public:
  // References must outlive it. record: its counts of time and work stay when the field is taken back, because they were spent.
  GoodState(render::TrainedField& field, FieldTrainer& trainer, const ContextBrightness* extras, SessionRecord& record)
      : field_(field), trainer_(trainer), extras_(extras), record_(record) {}

  bool Empty() const { return empty_; }
  // Of the kept state, updates done.
  int64_t step() const { return optimizer_.step; }
  // Steps between two states: copying takes about one per cent of the training. parameters: of the field; batch: samples per step. A
  // multiple of FallGuard::kWindow.
  static int64_t Interval(int64_t parameters, int batch);

  // Copies the present state.
  void Keep();
  // Takes the field back; the kept state stays.
  void Restore();
  // Calls `use` while the field has its kept state.
  void With(const std::function<void()>& use);

 private:
  void Exchange();
  std::span<const std::unique_ptr<ProposalNetwork>> Proposals() const;

  render::TrainedField& field_;
  FieldTrainer& trainer_;
  const ContextBrightness* extras_;  // null for blocks
  SessionRecord& record_;
  bool empty_ = true;
  field::Parameters parameters_;
  field::OptimizerState optimizer_;
  std::vector<float> tau_;
  std::vector<bool> occupied_;
  std::vector<uint8_t> judged_;
  std::vector<field::Parameters> proposals_;  // of a sampler
  std::vector<field::OptimizerState> proposal_optimizers_;
  int rays_per_step_ = 0;
  brightness::LuminanceState luminance_;
  AppearanceCodes::State codes_;
  PoseLearner::State poses_;
  SessionRecord kept_record_;
  brightness::Response response_;
  brightness::ResponseLearner::Moments moments_;
};

}  // namespace skyquilt::worker
