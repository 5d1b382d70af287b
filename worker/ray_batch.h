// The rays of one optimiser step and their samples, cut into packets of whole rays that one thread works on from density to gradient.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/ray_box.h"
#include "core/render/trained_field.h"
#include "worker/phase_times.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

struct BatchRay {
  PixelRay ray;
  int64_t begin = 0, count = 0;     // samples
  float background[3] = {0, 0, 0};  // random colour behind everything
  int64_t patch = 0;                // rays of one patch stand together
};

struct Packet {
  int64_t first_ray = 0, n_rays = 0;
  int64_t begin = 0, count = 0;  // samples
  size_t stride = 0;             // of its feature rows
  size_t features = 0;           // where they start, in rows-times-stride floats
};

// Structures of arrays; the samples of a packet start at a multiple of kernel::kPad.
struct RayBatch {
  std::vector<BatchRay> rays;
  std::vector<Packet> packets;
  std::vector<float> x, y, z;                                      // unit frame of the field
  std::vector<float> t;                                            // metres from the camera
  std::vector<float> unit_length;                                  // interval, in marching steps
  std::vector<int32_t> cell;                                       // of the occupancy grid
  int64_t n_samples = 0;                                           // without padding
  int64_t Size() const { return static_cast<int64_t>(x.size()); }  // with padding

  void Clear();
  // One more ray with its samples; rays of more than a packet's samples get one of their own.
  void Append(BatchRay ray, const float* x_in, const float* y_in, const float* z_in, const float* t_in, const float* unit_length_in,
              const int32_t* cell_in);
  // Closes the last packet and lays out feature rows (`rows` per sample).
  void CountAndReserve(int rows);
};

// Which rays count as neighbours in BatchRay::patch.
enum class Neighbours {
  kNone,   // every ray is alone
  kPatch,  // pixels are drawn in rows of kPatchPixels
  kBatch,  // unrelated rays that happen to be drawn one after the other
};
constexpr int kPatchPixels = 8;

// Draws n_rays pixels and marches them through the occupied cells. A pure function of (seed, step), whatever the threads.
class RayDrawer {
 public:
  // stratified: a ray's samples begin anywhere in its first step, else in the middle of it.
  RayDrawer(const render::TrainedField& target, const RaySource& source, uint64_t seed, Neighbours neighbours, bool stratified,
            base::ThreadPool& threads, PhaseTimes& times)
      : target_(target), source_(source), seed_(seed), neighbours_(neighbours), stratified_(stratified), threads_(threads), times_(times) {}
  void Draw(int64_t step, int n_rays, int feature_rows, RayBatch* batch);

 private:
  // What one task draws; the first `count` places of the arrays are filled.
  struct Group {
    std::vector<BatchRay> rays;
    std::vector<float> x, y, z, t, unit_length;
    std::vector<int32_t> cell;
    size_t count = 0;
    void MakeRoom(size_t samples);
  };
  void AddRay(BatchRay r, base::Random& random, Group& group) const;
  const render::TrainedField& target_;
  const RaySource& source_;
  uint64_t seed_;
  Neighbours neighbours_;
  bool stratified_;
  base::ThreadPool& threads_;
  PhaseTimes& times_;
  std::vector<Group> groups_;
};

// Mixes seed, step and index into the seed of one random sequence.
uint64_t MixSeed(uint64_t seed, uint64_t step, uint64_t index);

}  // namespace skyquilt::worker
