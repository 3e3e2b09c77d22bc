#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "app/commands.h"
#include "app/messages/with_progress.h"
#include "app/options/choices.h"
#include "app/options/flags.h"
#include "app/options/output_file.h"
#include "app/options/picture_file.h"
#include "app/options/polygon_file.h"
#include "app/options/renderer_options.h"
#include "app/options/scene_argument.h"
#include "app/options/text_values.h"
#include "app/process/clipped_scene.h"
#include "core/base/error.h"
#include "core/base/pluralize.h"
#include "format/system/message.h"
#include "format/system/publish.h"
#include "viewer/live/camera_path.h"
#include "viewer/live/path_frames.h"
#include "viewer/live/view_mode_legend.h"
#include "viewer/pictures/frame_renderer.h"
#include "viewer/pictures/image_files.h"

namespace gigabake::app {
namespace {

struct RenderArguments {
  std::string scene, picture, depth;
  std::string clip_box, clip_plane, polygons;
  std::string eye, target, up, size = "1280x720", background = "sky";
  double fovy_deg = CameraOptions{}.fovy_deg, pixel_error = CameraOptions{}.pixel_error;
  AreaOptions area;
  RendererArguments renderer;
  LightArguments light;
  SunArguments sun;
  std::string path, stats;
  ViewMode mode = ViewMode::lit;
  int frames = 0;
  double fps = 0, upload_ms = 20;
  bool live = false, quiet = false;
};

Background background_option(const std::string& text) {
  if (text == "sky") return {};
  const auto v = integers(text, ',');
  const bool good = v && (v->size() == 3 || v->size() == 4);
  if (good) {
    Background background{false, {0, 0, 0, 255}};
    bool in_range = true;
    for (std::size_t k = 0; k < v->size(); ++k) {
      in_range = in_range && (*v)[k] >= 0 && (*v)[k] <= 255;
      background.rgba[k] = std::uint8_t((*v)[k]);
    }
    if (in_range) return background;
  }
  throw UsageError(fmt::format("--background: expected sky, R,G,B or R,G,B,A with 0 to 255 each, got '{}'", text));
}

Clip clip_options(const RenderArguments& a) {
  Clip clip;
  if (!a.clip_box.empty()) {
    const auto v = numbers("--clip-box", "X,Y,Z,X,Y,Z: the lowest and the highest corner", a.clip_box, {6});
    clip.box_m = {Point<Scene>{v[0], v[1], v[2]}, Point<Scene>{v[3], v[4], v[5]}};
  }
  if (!a.clip_plane.empty()) {
    const auto v =
        numbers("--clip-plane", "X,Y,Z,DX,DY,DZ: a point and the direction to the shown side", a.clip_plane, {6});
    clip.plane = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  }
  return clip;
}

CameraOptions camera_options(const RenderArguments& a) {
  CameraOptions camera;
  camera.eye_m = point_option(a.eye, "--eye");
  camera.target_m = point_option(a.target, "--target");
  camera.up = point_option(a.up, "--up");
  std::tie(camera.width, camera.height) = size_option(a.size);
  camera.fovy_deg = a.fovy_deg;
  camera.pixel_error = a.pixel_error;
  camera.clip = clip_options(a);
  return camera;
}

View view_of(const RenderArguments& a) {
  if (!a.depth.empty() && picture_format("--depth", a.depth) != PictureFormat::exr)
    throw UsageError(fmt::format("--depth: expected a name that ends in .exr, got '{}'", a.depth));
  if (a.depth == a.picture) throw UsageError("--depth: expected another file than -o, which contains depth already");
  View view;
  const PictureFormat format = picture_format("-o", a.picture);
  if (format == PictureFormat::exr) view.light = PictureLight::linear_too;
  view.camera = camera_options(a);
  view.mode = a.mode;
  if (!a.polygons.empty()) view.polygons = read_polygons(a.polygons, a.renderer.threads);
  view.background = background_option(a.background);
  if (format == PictureFormat::jpeg && !view.background.sky && view.background.rgba[3] != 255)
    throw UsageError("--background: a JPEG is opaque; expected R,G,B, or a .png");
  return view;
}

FrameRenderer::Options renderer_options_of(const RenderArguments& a) {
  FrameRenderer::Options options = renderer_options(a.renderer);
  set_light(a.light, options);
  return options;
}

/// Prints the reasons for which images were rendered from coarser levels than requested. Returns the exit code.
int print_problems(const FrameRenderer& renderer) {
  for (const std::string& problem : renderer.problems())
    print_message("gigabake: rendered from coarser levels: {}\n", with_flags(problem));
  return renderer.problems().empty() ? complete : cells_failed;
}

/// Prints the legend of modes that do not show the scene's own colours.
void print_legend(ViewMode mode) {
  if (mode != ViewMode::lit) fmt::print("{}: {}\n", name_of(mode), view_mode_legend(mode));
}

/// Writes the files of one image. `name_of` returns the name of a file from the value of -o or --depth.
template <class NameOf>
void write_files(const RenderArguments& a, const Picture& picture, double voxel_size_m, const NameOf& name_of) {
  write_picture(name_of(a.picture), picture, voxel_size_m);
  if (!a.depth.empty()) write_exr(name_of(a.depth), picture, ExrChannels::depth, voxel_size_m);
}

/// Checks the files to write before anything is rendered.
void check_outputs(const RenderArguments& a) {
  std::vector<std::filesystem::path> inputs = files_of_bake(std::filesystem::path(a.scene).parent_path());
  inputs.emplace_back(a.path);
  inputs.emplace_back(a.polygons);
  for (const auto& [option, file] : {std::pair("-o", a.picture), {"--depth", a.depth}, {"--stats", a.stats}}) {
    expect_no_input(option, file, inputs);
    expect_parent_folder(option, file);
  }
}

int run(const RenderArguments& a) {
  View view = view_of(a);
  check_outputs(a);
  const ClippedScene scene(a.scene, a.area, a.renderer.threads, !a.quiet);
  FrameRenderer renderer(scene.file(), renderer_options_of(a));
  set_sun(a.sun, renderer.scene().header(), view);
  if (!a.quiet) print_sun(a.sun, view);
  const auto draw = [&](const Progress& progress) {
    Frame drawn = renderer.render_complete(view, progress);
    progress.step("writing the image");
    write_files(a, drawn.picture, renderer.scene().header().voxel_size_m, [](const std::string& name) { return name; });
    return drawn;
  };
  const Frame frame = with_progress(draw, a.quiet ? nullptr : stderr);
  if (!a.quiet) {
    fmt::print("{}: {}x{} in {:.2f} s; {} from {}, {:.0f} MB of voxels held\n", a.picture, frame.picture.width,
               frame.picture.height, frame.stats.total_s, pluralize(frame.stats.uploads, "upload"),
               pluralize(frame.stats.files_opened, "file"), double(frame.stats.bytes_held) / 1e6);
    print_legend(view.mode);
  }
  return print_problems(renderer);
}

std::vector<double> frame_times(const RenderArguments& a, const CameraPath& path) {
  if ((a.frames != 0) == (a.fps != 0)) throw UsageError("--path: expected either --frames or --fps");
  return a.frames != 0 ? times_of_frames(path, a.frames) : times_at_rate(path, a.fps);
}

/// Returns the names of the first and the last frame, as the end of a line.
std::string range_of_files(const RenderArguments& a, const std::vector<PathFrame>& frames) {
  if (frames.empty()) return "";
  const std::string first = numbered_file(a.picture, frames.front().number).string();
  if (frames.size() == 1) return ": " + first;
  return fmt::format(": {} to {}", first, numbered_file(a.picture, frames.back().number).string());
}

int run_path(const RenderArguments& a) {
  if (!(a.upload_ms > 0 && a.upload_ms <= 60000)) throw UsageError("--upload-ms: expected 0 to 60000 milliseconds");
  View view = view_of(a);
  check_outputs(a);
  numbered_file(a.picture, 0, "out");
  if (!a.depth.empty()) numbered_file(a.depth, 0, "depth");
  const ClippedScene scene(a.scene, a.area, a.renderer.threads, !a.quiet);
  FrameRenderer renderer(scene.file(), renderer_options_of(a));
  set_sun(a.sun, renderer.scene().header(), view);
  if (!a.quiet) print_sun(a.sun, view);
  const CameraPath path = read_camera_path(a.path, renderer.scene().header().origin);
  std::vector<PathFrame> frames;
  const auto take = [&](const PathFrame& frame, const Picture& picture) {
    write_files(a, picture, renderer.scene().header().voxel_size_m,
                [&](const std::string& name) { return numbered_file(name, frame.number); });
    frames.push_back(frame);
  };
  const auto draw = [&](const Progress& progress) {
    draw_path(renderer, path, view, frame_times(a, path), a.live ? Finish::live : Finish::complete, a.upload_ms / 1e3,
              take, progress);
  };
  with_progress(draw, a.quiet ? nullptr : stderr);
  if (!a.stats.empty()) publish_file(a.stats, to_json(frames));
  std::size_t incomplete = 0;
  for (const PathFrame& frame : frames) incomplete += frame.stats.complete ? 0 : 1;
  if (!a.quiet) {
    fmt::print("{}{}{}\n", pluralize(frames.size(), "frame"),
               incomplete > 0 ? fmt::format(", {} of them incomplete", incomplete) : "", range_of_files(a, frames));
    print_legend(view.mode);
  }
  return print_problems(renderer);
}

/// Rejects options that apply to a --path only.
void check_path_options(const RenderArguments& a) {
  if (a.frames != 0 || a.fps != 0 || a.live || !a.stats.empty())
    throw UsageError("--frames, --fps, --live and --stats: expected --path as well");
}

}  // namespace

void add_render(CLI::App& app, int& exit_code) {
  const auto a = std::make_shared<RenderArguments>();
  CLI::App& command = *app.add_subcommand("render", "Render a baked scene: one image, or many along a path");
  command.add_option("SCENE", a->scene, "folder of a bake, or its scene.xml")->required();
  command
      .add_option("-o,--output", a->picture,
                  "image to write: .png, .jpg or .exr (OpenEXR, linear light and depth); along a path: a pattern such "
                  "as frames/%04d.png")
      ->required();
  command.add_option("--depth", a->depth,
                     "additional OpenEXR file to write: distances, metres; along a path: a pattern as for -o");
  command.add_option("--eye", a->eye, "X,Y,Z: camera, scene metres (south-east of the target, all in view)");
  command.add_option("--target", a->target, "X,Y,Z: point at the centre of the image (the middle of the scene)");
  command.add_option("--up", a->up, "X,Y,Z: direction that is up in the image (0,0,1)");
  command.add_option("--fovy", a->fovy_deg, "vertical field of view, degrees")->capture_default_str();
  command.add_option("--size", a->size, "WIDTHxHEIGHT in pixels")->capture_default_str();
  command.add_option("--background", a->background, "sky, or R,G,B[,A]: sRGB, 0 to 255 each")->capture_default_str();
  command.add_option("--pixel-error", a->pixel_error, "max width of a voxel in pixels")->capture_default_str();
  command.add_option("--clip-box", a->clip_box, "X,Y,Z,X,Y,Z: show only voxels in this box, scene metres");
  command.add_option("--clip-plane", a->clip_plane,
                     "X,Y,Z,DX,DY,DZ: show only the side of the plane through X,Y,Z to which DX,DY,DZ points");
  command.add_option(
      "--polygons", a->polygons,
      "mesh file, such as .glb, in scene metres: its triangles are rendered with the voxels, in colour and depth");
  a->area.add_to(command);
  add_light_options(command, a->light);
  add_sun_options(command, a->sun);
  add_renderer_options(command, a->renderer);
  command.add_option("--path", a->path, "camera path, JSON (docs/viewer.md); instead of --eye and --target");
  command.add_option("--frames", a->frames, "number of frames, evenly distributed along the path");
  command.add_option("--fps", a->fps, "frames per second of the path");
  add_choice(command, "--mode", a->mode, "quantity to show; its colours: see below");
  command.add_option("--stats", a->stats, "JSON file to write: the statistics of each frame of the path");
  command.add_flag("--live", a->live, "render each frame once, complete or not, as an interactive viewer shows it");
  command.add_option("--upload-ms", a->upload_ms, "milliseconds for uploads per frame of --live")
      ->capture_default_str();
  command.add_flag("-q,--quiet", a->quiet, "print only errors");
  command.callback([a, &exit_code] {
    if (a->path.empty()) check_path_options(*a);
    a->scene = scene_argument(a->scene).string();
    exit_code = a->path.empty() ? run(*a) : run_path(*a);
  });
}

}  // namespace gigabake::app
