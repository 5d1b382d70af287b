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
  double painted_cells = 0.0;   // of the orthophoto from photos

  // Of a machine with two such threads as docs/benchmarks.md tells of, scaled to this number of threads.
  static Rates Usual(int threads);
  // Rays follow from the speed of training where nothing better is known.
  void TakeSamples(double samples_per_second);
};

}  // namespace skyquilt::coordinator
