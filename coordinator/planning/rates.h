// How fast a machine does the parts of the work.
#pragma once

namespace skyquilt::coordinator {

// Per second, all threads of one machine together.
struct Rates {
  double decoded_pixels = 0.0;  // of photo files
  double feature_pixels = 0.0;  // of photos at the size at which features are searched
  double matched_pairs = 0.0;   // of photos with 4096 features each
  double samples = 0.0;         // of training
  double rays = 0.0;            // rendered from the places of photos
  double scored_pixels = 0.0;   // compared with a photo, all scores together
  double painted_pixels = 0.0;  // of the photos that an orthophoto is made from
  double fused_pixels = 0.0;    // of the views that a surface is made from
  double texels = 0.0;          // of its texture: short rays, which few empty samples slow down

  // Of a machine with two such threads as docs/benchmarks.md tells of, scaled to this number of threads.
  static Rates Usual(int threads);
  // Training was measured, so the machine is known to be faster or slower than the usual one: so are rays, scores, painting and fusion, which were
  // not.
  void TakeSamples(double samples_per_second);
};

}  // namespace skyquilt::coordinator
