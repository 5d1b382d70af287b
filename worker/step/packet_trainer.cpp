#include "worker/step/packet_trainer.h"

namespace skyquilt::worker {
namespace {

template <typename Part>
void KeepIf(bool wanted, std::optional<Part>& part, const PacketShared& shared) {
  if (!wanted) part.reset();
  if (wanted && !part) part.emplace(shared);
}

}  // namespace

PacketTrainer::PacketTrainer(const PacketShared& shared, PhaseTimes& times, int thread)
    : shared_(shared), times_(times), thread_(thread), density_(shared), color_(shared), poses_(shared) {
  KeepIf(shared.context != nullptr, context_, shared);
  KeepIf(shared.luminance.On(), concealed_, shared);
  KeepIf(!concealed_, losses_, shared);
}

void PacketTrainer::ChoosePriors(const StepPriors& priors) {
  KeepIf(losses_ && priors.Distances(), ends_, shared_);
  KeepIf(ends_ && priors.Normals(), normals_, shared_);
}

PacketResult PacketTrainer::Train(const PacketStep& step, const Packet& packet, float* network_gradient) {
  auto at = PhaseTimes::Clock::now();
  ChoosePriors(step.priors);
  samples_.Begin(step, packet, shared_.field);
  samples_.a.by_direction = step.ray_gradients != nullptr;
  density_.Forward(samples_);
  density_.DropHidden(samples_);
  at = times_.Add(thread_, Phase::kDensity, at);
  color_.Forward(samples_);
  at = times_.Add(thread_, Phase::kColor, at);
  if (context_) context_->Render(samples_);
  at = times_.Add(thread_, Phase::kContext, at);
  PacketResult result;
  result.gradient = {packet.begin, samples_.live, samples_.Features(), packet.stride};
  if (concealed_) concealed_->Add(samples_, network_gradient, result.sums);
  if (losses_) losses_->Add(samples_, ends_ ? &*ends_ : nullptr, result.sums);
  result.saturated = {density_.FinishGradient(samples_), color_.FinishGradient(samples_)};
  const float* more_geometry_gradient = nullptr;
  if (normals_) {
    SurfacePoints& points = step.surface_points[&packet - step.batch.packets.data()];
    more_geometry_gradient = normals_->Add(samples_, *ends_, points, network_gradient, result.sums);
    result.finite = kernel::AllFinite(points.feature_gradient.data(), static_cast<int64_t>(points.feature_gradient.size())) &&
                    kernel::AllFinite(points.along.data(), static_cast<int64_t>(points.along.size()));
  }
  at = times_.Add(thread_, Phase::kCompose, at);
  if (samples_.live > 0) result.finite = Backward(network_gradient, more_geometry_gradient) && result.finite;
  times_.Add(thread_, Phase::kBackward, at);
  return result;
}

void PacketTrainer::Infer(const PacketStep& step, const Packet& packet) {
  auto at = PhaseTimes::Clock::now();
  samples_.Begin(step, packet, shared_.field);
  density_.Forward(samples_);
  PacketDensity::KeepAll(samples_);
  at = times_.Add(thread_, Phase::kDensity, at);
  color_.Forward(samples_);
  times_.Add(thread_, Phase::kColor, at);
}

bool PacketTrainer::Backward(float* network_gradient, const float* more_geometry_gradient) {
  float* features = samples_.Features();
  const size_t stride = samples_.packet->stride;
  shared_.field.Backward(samples_.step->weights, samples_.a, features, stride, samples_.Padded(), network_gradient, more_geometry_gradient);
  color_.SumCodeGradients(samples_);
  if (samples_.step->ray_gradients != nullptr) poses_.Add(samples_);
  bool finite = true;
  for (int row = 0; row < shared_.field.encoding().OutputRows(); ++row) {
    finite = finite && kernel::AllFinite(features + static_cast<size_t>(row) * stride, samples_.live);
  }
  return finite;
}

}  // namespace skyquilt::worker
