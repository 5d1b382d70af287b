// `skyquilt simulate`: makes the photos of a drone survey of an invented place, for tests and demonstrations. Poses, surfaces, brightness and
// buildings are known exactly, so results can be compared with the truth. Written to the folder:
//   images/IMG_0001.jpg ...            photos with EXIF and XMP tags like those of a drone, or of a phone without GPS (simulate.flight)
//   sparse/0/{cameras,images,points3D}.bin   COLMAP model of the true poses in the ENU frame of the origin, metres; without exact_frame in another
//   truth/depth/<stem>.tiff            depth of the test photos (every test_every-th in name order): metres along the camera's z, NaN = sky
//   truth/normals/<stem>.png           normals of their surfaces (core/image/normal_image.h): of the triangles, ENU, on the camera's side
//   truth/classes/<stem>.png           what their surfaces are: 8 bits, one channel, the numbers of core/survey/surface_class.h;
//                                      of all photos with simulate.class_images = all
//   truth/surface.ply                  the static surface as a mesh, ENU metres, with the class of each face (simulate/surface_mesh.h)
//   truth/orthophoto.tif               the true orthophoto, RGBA in UTM, with simulate.ortho_cell_m (true_orthophoto.h)
//   truth/edge_targets.json            where slanted edges are, with simulate.edge_targets (edge_targets.h)
//   truth/cloudless/<name>.jpg         the test photos at normal exposure without shadows of clouds, with simulate.cloud_shadows
//   truth/masks/<name>.jpg.png         0 on a moving car, a person or their shadows; only for photos that show one
//   truth/exposure.json                brightness of every photo
//   truth/buildings.json               position and size of every part of a building, and the outlines that parts have together
//   video/flight.mp4, flight.SRT       with simulate.video_fps: the same flight filmed (flights/video_flight.h), and truth/video_poses.csv
//   panoramas/PANO_0001.jpg            with simulate.panoramas: from places of the flight (flights/panorama_flight.h), and truth/panorama_poses.csv
//   control/                           ground control as several programs write it (control_writer.h), with simulate.control_points or check_points
//   simulate.json                      place, origin, options, suggested blocks, the true frame of a model without exact_frame; written last
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "simulate/flight.h"
#include "simulate/place_spec.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {

class World;

struct SimulateSummary {
  int n_photos = 0;
  int n_test = 0;
  int n_points = 0;
  int n_buildings = 0;
  int n_masks = 0;
  int n_control = 0;  // targets of control and check points
  double seconds = 0.0;
};

// Allowed values of simulate.place: hamlet, town, smallcity, tidalflat, solar_farm.
std::vector<std::string> PlaceNames();

// The same options give the same bytes, for any number of threads. An earlier simulation in the folder is replaced.
// Throws base::UsageError that names an option which cannot be used, base::InputError if the folder cannot be written or has images/, sparse/,
// truth/ or control/ from elsewhere, base::Interrupted.
SimulateSummary Simulate(const SimulateOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads);

// Plans a survey's photos in the order of capture, once the place is built. Names must be unique file names.
using FlightPlanner = std::function<std::vector<PhotoPlan>(const PlaceSpec& place, const World& world)>;
// The same with the photos of `plan`, for instance of flights at several heights. options.test_every is not used: the plan says which photos get
// true depth, normals and classes. Errors of the tags are added to the plan.
SimulateSummary Simulate(const SimulateOptions& options, const std::filesystem::path& folder, base::ThreadPool& threads, const FlightPlanner& plan);

}  // namespace skyquilt::simulate
