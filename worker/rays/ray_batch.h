// The rays of one optimiser step and their samples. They are divided into packets of whole rays: one thread computes everything from density to
// gradient for a packet while its data is in cache.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/ray_box.h"
#include "core/render/trained_field.h"
#include "worker/phase_times.h"
#include "worker/rays/depth_points.h"
#include "worker/rays/ray_source.h"
#include "worker/samplers/bin_sampler.h"

namespace skyquilt::worker {

struct BatchRay {
  PixelRay ray;
  int64_t begin = 0, count = 0;     // its samples in the batch
  float background[3] = {0, 0, 0};  // random colour behind everything, so that surfaces must become opaque
  int64_t patch = 0;                // rays of one patch are neighbours and follow each other
  int64_t segment = -1;             // rays of one segment of a photo have its number and follow each other in one packet; -1: none
  int64_t segment_samples = 0;      // of the first ray of a segment: samples of all its rays
};

struct Packet {
  int64_t first_ray = 0, n_rays = 0;
  int64_t begin = 0, count = 0;  // its samples in the batch
  size_t stride = 0;             // of its feature rows
  size_t features = 0;           // offset of its feature rows, in floats
};

// Structure of arrays; the samples of a packet start at a multiple of kernel::kPad.
struct RayBatch {
  std::vector<BatchRay> rays;
  std::vector<Packet> packets;
  int points = 1;                  // positions per sample
  size_t plane = 0;                // room for samples: position j of sample s is element j * plane + s of x, y, z
  std::vector<float> x, y, z;      // unit frame of the field
  std::vector<float> sharpness;    // of the footprints (kernel::Positions); not used without cones
  std::vector<float> t;            // metres from the camera
  std::vector<float> unit_length;  // length of the interval in marching steps
  bool uneven = false;             // whether these lengths are all different: those of bins
  // Index in the occupancy grid. Negative: ~cell is one, drawn at random, of the cells that the sample stands for; it is too coarse to tell them
  // apart.
  std::vector<int32_t> cell;
  int64_t n_samples = 0;                                           // without padding
  int64_t Size() const { return static_cast<int64_t>(t.size()); }  // with padding

  // positions: of every sample that is appended from now on.
  void Clear(int positions = 1);
  // Positions of all samples, for a field with this configuration.
  kernel::Positions Positions(const field::FieldConfig& config) const {
    return {x.data(), y.data(), z.data(), config.Cones() ? sharpness.data() : nullptr, points, plane};
  }
  // Appends a ray with ray.count samples. A ray with more samples than a packet holds gets a packet of its own. x_in, y_in, z_in: the positions of a
  // sample follow each other.
  void Append(BatchRay ray, const float* x_in, const float* y_in, const float* z_in, const float* sharpness_in, const float* t_in,
              const float* unit_length_in, const int32_t* cell_in);
  // Completes the last packet and sets the packets' feature ranges, for `rows` features per sample.
  void LayOutFeatures(int rows);

 private:
  void MakeRoom(size_t samples);
  void PadTo(size_t end);
};

// Which rays are neighbours (BatchRay::patch), for the convolution of a concealing field.
enum class Neighbours {
  kNone,   // none
  kPatch,  // rows of kPatchPixels neighbouring pixels
  kBatch,  // unrelated rays in the order in which they were drawn
};
constexpr int kPatchPixels = 8;

// Shares of the rays that are drawn in groups of kSegmentRays within segments, and towards sparse points. Null: none.
struct PriorRays {
  const PhotoSegments* segments = nullptr;
  double segment_share = 0.0;
  const DepthPoints* points = nullptr;
  double point_share = 0.0;
};

// Draws the pixels of a batch and samples their rays: in occupied cells, or where a BinSampler places their samples. A pure function of (seed, step)
// and the fields for any number of threads.
class RayDrawer {
 public:
  // stratified: true: a ray's samples are shifted by a random part of a step; false: they are in the middle of the steps. sampler: null: occupied
  // cells. References must outlive it.
  RayDrawer(const render::TrainedField& target, const RaySource& source, uint64_t seed, Neighbours neighbours, bool stratified, BinSampler* sampler,
            base::ThreadPool& threads, PhaseTimes& times)
      : target_(target),
        source_(source),
        seed_(seed),
        neighbours_(neighbours),
        stratified_(stratified),
        sampler_(sampler),
        threads_(threads),
        times_(times) {}
  // Groups into which about n_rays rays are divided.
  static int64_t Groups(int n_rays);
  // About n_rays rays: masked pixels and rays that miss the field are left out. After BinSampler::Begin for Groups(n_rays).
  void Draw(int64_t step, int n_rays, int feature_rows, const PhotoPyramid& pyramid, const PriorRays& priors, RayBatch* batch);

 private:
  // The rays of one task; the first `count` elements of the arrays are used.
  struct Group {
    std::vector<BatchRay> rays;
    // The positions of a sample follow each other in x, y and z.
    std::vector<float> x, y, z, sharpness, t, unit_length;
    std::vector<int32_t> cell;
    size_t count = 0;
    std::vector<BinnedRay> binned;  // of the rays, for a sampler of bins
    void MakeRoom(size_t samples, int points);
  };
  // Appends the samples of one ray to the group.
  class SampleWriter;
  void AddRay(BatchRay r, base::Random& random, Group& group) const;
  // Where all rays of the group are known: places their samples.
  void AddBins(int64_t task, base::Random& random, int thread, Group& group) const;
  // Returns the number of rays drawn.
  int AddPriorRays(const PriorRays& priors, int64_t task, base::Random& random, Group& group) const;
  const render::TrainedField& target_;
  const RaySource& source_;
  uint64_t seed_;
  Neighbours neighbours_;
  bool stratified_;
  BinSampler* sampler_;
  base::ThreadPool& threads_;
  PhaseTimes& times_;
  std::vector<Group> groups_;
};

// Hashes seed, step and index into the seed of one random sequence.
uint64_t MixSeed(uint64_t seed, uint64_t step, uint64_t index);

}  // namespace skyquilt::worker
