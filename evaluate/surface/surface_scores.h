// Scores of the surface that was made from the scene (surface/make_surface.h): its textured mesh in held-out photos and, for simulated surveys, in
// space. NaN: not measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "evaluate/measured.h"

namespace skyquilt::evaluate::surface {

// Shares of two surfaces that are within a distance of each other (Knapitsch et al. 2017, Tanks and Temples), in [0, 1].
struct SurfaceFScore {
  std::string tau;                  // "2 GSD", "10 cm"
  double tau_m = 0.0;               // the distance
  double precision = kNotMeasured;  // of the mesh's samples, those nearer than tau to the true surface
  double recall = kNotMeasured;     // of the true surface's samples, those nearer than tau to the mesh
  double f = kNotMeasured;          // harmonic mean
};

// Mesh against true surface, over the part of the true surface that at least two training photos see.
struct SurfaceAgreement {
  int64_t mesh_samples = 0;  // by area
  int64_t true_samples = 0;
  // Median distances to the other surface; infinite where most samples have none near them.
  double accuracy_median_m = kNotMeasured;      // of the mesh's samples
  double completeness_median_m = kNotMeasured;  // of the true surface's samples
  std::vector<SurfaceFScore> f_scores = {};     // at 1, 2 and 5 GSD, then 5, 10 and 20 cm; empty: not measured
};

struct SurfaceClassScore {
  std::string name;               // roof, wall, ground (roads included), road, tree
  int64_t pixels = 0;             // covered pixels of all held-out photos
  int64_t missing_pixels = 0;     // of them without mesh
  double psnr_db = kNotMeasured;  // of the mesh, pooled over them
  double psnr_field_db = kNotMeasured;
  SurfaceAgreement agreement = {};  // mesh samples belong to the class of the nearest true triangle
};

// A file, or a set of files, of the folder surface/; see surface/written_file.h.
struct SurfaceFile {
  std::string file;  // relative to that folder
  std::string content, format, crs, vertical;
  int64_t bytes = 0;
  std::string detail;
};

// What surface.json says about the making of it. -1 or NaN where it says nothing.
struct SurfaceRecord {
  int64_t triangles = -1;
  int64_t edges = -1, boundary_edges = -1, non_manifold_edges = -1;
  int64_t points = -1;  // of the point cloud
  int64_t photos = -1, virtual_views = -1;
  double area_m2 = kNotMeasured;
  double filled_m2 = kNotMeasured;  // closed holes and gaps
  double voxel_m = kNotMeasured;
  double seconds = kNotMeasured;
  std::vector<SurfaceFile> files;
};

struct SurfaceScores {
  // Means over the held-out photos of the values per photo, over the pixels that Metrics::psnr counts. A pixel without mesh is black.
  double psnr = kNotMeasured;
  double psnr_field = kNotMeasured;
  double psnr_where_mesh = kNotMeasured;  // over those of them that have mesh
  double psnr_field_where_mesh = kNotMeasured;
  int64_t pixels = 0;
  double missing_share = kNotMeasured;  // pixels without mesh, of the pixels of all photos
  SurfaceAgreement agreement;           // simulated surveys only, as the two below
  int64_t deck_samples = 0;             // of the mesh on the decks of flat roofs (decks.h)
  double decks_within_2_gsd = kNotMeasured;
  std::vector<SurfaceClassScore> classes;  // empty without true classes
  SurfaceRecord record;
};

}  // namespace skyquilt::evaluate::surface
