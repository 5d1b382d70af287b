#include <CLI/CLI.hpp>
#include <optional>

#include "app/commands/command.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/stages/training_width.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/scene/scene.h"
#include "core/survey/refined_poses.h"
#include "products/camera_path.h"
#include "products/elevation.h"
#include "products/map_products.h"
#include "products/render_views.h"
#include "products/trust_map.h"

namespace skyquilt::app {
namespace {

struct RenderFlags {
  std::string target;
  std::vector<std::string> photos;
  std::string path;
  std::string out;
  int width = 0;
  bool test = false;
  bool video = false;
  bool ortho = false;
  bool dsm = false;
  std::string plane;  // of elevations: auto or the numbers of one; empty: none
  bool no_depth = false;
  std::string normals;  // kind; empty: none
  bool trust = false;
  bool restart = false;

  bool Views() const { return !photos.empty() || test || (!path.empty() && !video); }
  bool Anything() const { return !photos.empty() || test || !path.empty() || video || Maps(); }
  bool Maps() const { return ortho || dsm || !plane.empty() || TrustMap(); }
  bool TrustMap() const { return trust && (!Views() || ortho || dsm); }
};

// The scene to render, and its project if it is inside one.
struct Target {
  std::filesystem::path scene;
  std::optional<coordinator::Project> project;
};

Target FindTarget(const std::filesystem::path& path) {
  if (std::filesystem::is_regular_file(path)) {
    const std::filesystem::path folder = std::filesystem::absolute(path).lexically_normal().parent_path();
    return {path, coordinator::Project::IsProject(folder) ? std::optional<coordinator::Project>(coordinator::Project{folder}) : std::nullopt};
  }
  if (path.extension() == ".h5") throw base::InputError(path, "no such file", "Make it with 'skyquilt merge' in its project");
  const coordinator::Project project = coordinator::Project::Open(path);
  return {project.SceneFile(), project};
}

void LogStats(const products::RenderStats& stats, const std::filesystem::path& where) {
  base::LogInfo("{} image(s), {} rays/s: {}", stats.views, base::FormatCount(stats.RaysPerSecond()), where.string());
}

void RenderAsked(const RenderFlags& flags, const Target& target, const coordinator::Settings& settings, coordinator::SceneSession& session,
                 const std::filesystem::path& renders, const std::filesystem::path& maps) {
  const products::ProductOptions& options = settings.products;
  base::ThreadPool& threads = session.threads();
  const scene::Scene& scene = session.scene();
  products::ViewImages images;
  images.depth = !flags.no_depth;
  if (!flags.normals.empty()) images.normals = products::NormalKindNamed(flags.normals);
  if (images.normals) products::RequireNormals(*images.normals, scene.info());
  std::optional<trust::Trust> trust;
  if (flags.trust) {
    trust = trust::LoadTrustOf(target.scene);
    images.trust = &*trust;
    images.cones = scene.info().scales.Cones();
  }
  scene::Appearance appearance = products::AppearanceOf(options.exposure, scene.info());
  appearance.normals = images.normals && products::NeedsRenderedNormals(*images.normals);
  const products::ViewRenderer renderer = products::RendererOf(scene, appearance, threads);
  scene::Appearance for_people = appearance;
  for_people.plain_surround = options.plain_surround;
  const products::ViewRenderer path_renderer = products::RendererOf(scene, for_people, threads);
  const int path_width = flags.width > 0 ? flags.width / 2 * 2 : options.video_width;
  const int path_height = std::max(2, path_width * options.video_height / options.video_width / 2 * 2);
  const bool along_cameras = flags.video && flags.path.empty() && options.video_path == "cameras";
  const bool needs_survey = !flags.photos.empty() || flags.test || flags.plane == "auto" || along_cameras;
  std::optional<survey::Survey> survey;
  if (needs_survey && !target.project) {
    throw base::UsageError(
        "--photo, --test, --plane auto and a video along the cameras need the survey: give the project folder, or a scene.h5 inside its project");
  }
  const bool from_photos = target.project && flags.ortho && options.ortho_source == "photos";
  if (target.project && (needs_survey || from_photos || !flags.plane.empty())) survey = survey::LoadRefinedSurvey(target.project->SurveyFolder());
  if (!flags.photos.empty() || flags.test) {
    std::vector<products::View> views;
    if (flags.test) views = products::ViewsOfPhotos(*survey, {}, flags.width);
    if (!flags.photos.empty()) {
      const std::vector<products::View> named = products::ViewsOfPhotos(*survey, flags.photos, flags.width);
      views.insert(views.end(), named.begin(), named.end());
    }
    LogStats(products::RenderViews(renderer, views, renders, images, threads), renders);
  }
  if (!flags.path.empty()) {
    const std::vector<products::View> views = products::LoadCameraPath(flags.path, scene.info(), path_width, path_height);
    const std::string stem = std::filesystem::path(flags.path).stem().string();
    if (flags.video) {
      std::filesystem::create_directories(renders);
      LogStats(products::RenderVideo(path_renderer, views, options.video_fps, renders / (stem + ".mp4")), renders / (stem + ".mp4"));
    } else {
      LogStats(products::RenderViews(path_renderer, views, renders / stem, images, threads), renders / stem);
    }
  } else if (flags.video) {
    products::ProductOptions video = options;
    if (!(video.video_seconds > 0.0)) video.video_seconds = products::ProductOptions().video_seconds;
    video.video_width = path_width;
    video.video_height = path_height;
    std::filesystem::create_directories(renders);
    const std::filesystem::path file = renders / (options.video_path + ".mp4");
    const std::vector<products::View> views = along_cameras ? products::PathAlongCameras(*survey, video) : products::BuiltInPath(scene.info(), video);
    LogStats(products::RenderVideo(path_renderer, views, options.video_fps, file), file);
  }
  if (flags.ortho || flags.dsm) {
    products::ProductOptions asked = options;
    asked.ortho = flags.ortho;
    asked.dsm = flags.dsm;
    std::optional<products::MapPhotos> photos;
    std::unique_ptr<products::TileService> tiles;
    if (from_photos) {
      tiles = session.TileServiceFor(target.project->SurveyFolder());
      photos.emplace(products::MapPhotos{*survey, products::PictureMemory(settings.run.MemoryLimitBytes()), threads, tiles.get()});
    }
    products::LogMaps(products::MakeMapProducts(scene, asked, maps, threads, photos ? &*photos : nullptr), maps);
  }
  if (flags.TrustMap()) {
    const std::filesystem::path map =
        products::WriteTrustMap(*trust, scene.info(), products::CasterOf(scene, appearance, threads), options, maps, threads);
    base::LogInfo("map of the errors to expect: {}", map.string());
  }
  if (!flags.plane.empty()) {
    const products::RayCaster caster = products::CasterOf(scene, products::AppearanceOf(options.exposure, scene.info()), threads);
    const int image_width = settings.run.image_width;
    if (flags.plane == "auto") {
      products::WriteElevationsOfWalls(scene.info(), *survey, caster, options, image_width, maps, !flags.no_depth);
    } else {
      const products::ElevationPlane plane = products::StatedElevation(flags.plane, scene.info(), survey ? &*survey : nullptr, options, image_width);
      products::WriteElevation(plane, scene.info(), caster, options, maps, !flags.no_depth);
    }
  }
}

void Render(const CommandState& state, const RenderFlags& flags, const std::vector<config::Override>& overrides) {
  if (flags.width < 0) throw base::UsageError("--width " + std::to_string(flags.width) + " is not allowed: give a number of pixels, or 0");
  if (!flags.normals.empty()) {
    products::NormalKindNamed(flags.normals);
    if (!flags.Views()) throw base::UsageError("--normals needs views to draw: give --photo, --test, or --path without --video");
  }
  const Target target = FindTarget(flags.target);
  coordinator::Settings settings = state.Load(target.project ? ProjectConfig(*target.project) : std::vector<std::filesystem::path>{}, overrides);
  if (target.project) coordinator::RecallTrainingWidth(*target.project, &settings);
  if (!flags.Anything()) {
    if (!target.project)
      throw base::UsageError("nothing to render from " + flags.target + " was chosen. Give --path, --video, --ortho, --dsm, --trust or --plane");
    coordinator::Pipeline pipeline = state.Begin(*target.project, std::move(settings), flags.restart);
    coordinator::ProductsStage(pipeline);
    return;
  }
  const std::filesystem::path folder = std::filesystem::absolute(target.scene).lexically_normal().parent_path();
  const std::filesystem::path renders = flags.out.empty() ? folder / "renders" : std::filesystem::path(flags.out);
  const std::filesystem::path maps = flags.out.empty() ? folder / "products" : std::filesystem::path(flags.out);
  base::RequireWritableFolder(flags.Maps() ? maps : renders);
  coordinator::SceneSession session(*state.comm, target.scene, settings.run, state.verbose, state.quiet);
  RenderAsked(flags, target, settings, session, renders, maps);
}

}  // namespace

void AddRender(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<RenderFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("render", "render images, depth, video, orthophoto, surface model and elevations of a scene");
  command->add_option("scene", flags->target, "project folder or scene.h5")->required()->type_name("PATH");
  command->add_option("--photo", flags->photos, "render the view of this photo; may be repeated")->type_name("NAME")->expected(1)->take_all();
  command->add_flag("--test", flags->test, "render the views of all held-out photos");
  command->add_option("--path", flags->path, "render a camera path from a JSON file")->type_name("FILE");
  command->add_flag("--video", flags->video, "make an MP4 video along --path, or along the built-in path of [products]");
  command->add_flag("--ortho", flags->ortho, "make the orthophoto as GeoTIFF");
  command->add_flag("--dsm", flags->dsm, "make the surface model as GeoTIFF");
  command
      ->add_option(
          "--plane", flags->plane,
          "draw elevations, straight on vertical planes: auto finds the walls; or x,y,z,azimuth[,width,height], the middle of the picture, to "
          "where the wall looks (degrees clockwise from north) and the size")
      ->type_name("PLANE");
  command->add_flag("--no-depth", flags->no_depth, "do not write depth images");
  command->add_option("--normals", flags->normals, "also write the surface normals of the views: depth (the default), density or predicted")
      ->type_name("KIND")
      ->expected(0, 1)
      ->default_str("depth");
  command->add_flag("--trust", flags->trust,
                    "also write the errors to expect of the views; without views, or with --ortho or --dsm, a map of them as GeoTIFF");
  AddOptionFlag(*command, overrides, "--exposure", "products.exposure",
                "exposure of the images: normal, a number of stops above it, or a photo's name to use its exposure");
  AddOptionFlag(*command, overrides, "--resolution", "products.resolution_m", "cell size of orthophoto, surface model and elevations in metres");
  AddBoundaryFlag(*command, overrides);
  AddMemoryFlag(*command, overrides);
  command->add_option("--width", flags->width, "image width in pixels; 0: size of the photos, with --path and --video products.video_width")
      ->type_name("N");
  command->add_option("-o,--out", flags->out, "output folder; default: renders/ and products/ beside the scene")->type_name("FOLDER");
  command->add_flag("--restart", flags->restart,
                    "remove products, renders and report first; only when none of the flags above chooses what to render");
  command->footer(
      "Examples:\n"
      "  skyquilt render out                           the products chosen in [products]\n"
      "  skyquilt render out --test --width 1000\n"
      "  skyquilt render out --photo IMG_0007.jpg --exposure 1\n"
      "  skyquilt render out/scene.h5 --path flight.json --video -o movie\n"
      "  skyquilt render out --ortho --dsm --resolution 0.05\n"
      "  skyquilt render out --trust                   map of the errors to expect\n"
      "  skyquilt render out --plane auto\n"
      "  skyquilt render out --plane 12.5,3,8,180,40,16 --resolution 0.01");
  command->callback([&state, flags, overrides] { state.run_command = [&state, flags, overrides] { Render(state, *flags, *overrides); }; });
}

}  // namespace skyquilt::app
