#include <fmt/format.h>
#include <memory>
#include <optional>
#include <utility>

#include "app/commands.h"
#include "app/edit/bake_record.h"
#include "app/edit/edit_options.h"
#include "app/options/scene_argument.h"
#include "app/process/bake_run.h"
#include "app/process/on_all_ranks.h"
#include "app/process/rank_start.h"
#include "cluster/edit/scene_edits.h"
#include "cluster/process/drain.h"
#include "core/base/error.h"
#include "format/edit/edit_json.h"
#include "format/edit/scene_edits.h"
#include "format/scene/paged_scene.h"

namespace gigabake::app {
namespace {

struct EditArguments {
  std::string scene;
  EditOptions edits;
  bool list = false, undo = false, json = false, quiet = false;
  int threads = 0;
  std::optional<int> ranks;
};

/// Errors  UsageError: there is nothing to do, or more than one command does.
void check(const EditArguments& arguments) {
  if (arguments.list && (arguments.undo || !arguments.edits.empty()))
    throw UsageError("--list only prints the edits of the scene; it excludes --undo and new edits");
  if (!arguments.list && !arguments.undo && arguments.edits.empty())
    throw UsageError("expected an edit, such as --carve SHAPE or --from EDITS.json, or --undo or --list");
}

/// Returns the change of SCENE/edits.json that the arguments request.
EditsChange change_of(const EditArguments& arguments, const std::filesystem::path& folder) {
  EditsChange change{read_edits_file(folder), {}};
  SceneEditList all = edits_of_file(folder, change.before);
  const SceneEditList added = arguments.edits.edits();
  if (arguments.undo) {
    if (!added.empty()) throw UsageError("--undo removes the last edit, and adds none");
    if (all.empty()) throw UsageError("--undo: the scene has no edits; edits of a scene .json are removed there");
    all.pop_back();
  }
  all.insert(all.end(), added.begin(), added.end());
  if (all.size() > max_edits) throw UsageError(fmt::format("--from: a scene has at most {} edits", max_edits));
  if (!all.empty()) change.after = to_json(all);
  return change;
}

int print_list(const EditArguments& arguments, const std::filesystem::path& folder) {
  const SceneEditList edits = edits_of_file(folder, read_edits_file(folder));
  if (arguments.json) {
    fmt::print("{}", to_json(edits));
    return complete;
  }
  for (const SceneEdit& edit : edits) fmt::print("{}: {}\n", key_of(edit), to_json(edit));
  if (edits.empty()) fmt::print("no edits\n");
  return complete;
}

/// Returns the request that bakes the scene again with the changed edits. A scene without losses must stay so.
BakeRequest request_of(const EditArguments& arguments, const std::filesystem::path& folder, MpiSession& mpi) {
  BakeOptions options;
  std::optional<EditsChange> change;
  bool is_whole = true;
  check_options_collectively(mpi, [&] {
    options = recorded_bake(folder);
    change = change_of(arguments, folder);
    is_whole = PagedScene(folder / "scene.xml").header().losses.empty();
  });
  options.asked.threads = arguments.threads;
  options.asked.keep_going = !is_whole;
  BakeRequest request = options.request_of(mpi);
  request.edits = std::move(change);
  return request;
}

int run(const EditArguments& arguments, MpiSession& mpi) {
  const std::filesystem::path folder = scene_argument(arguments.scene).parent_path();
  const BakeOutput output{arguments.json, arguments.quiet, std::nullopt, {}};
  return run_bake(request_of(arguments, folder, mpi), output, mpi);
}

}  // namespace

void add_edit(CLI::App& app, int& exit_code) {
  auto* command =
      app.add_subcommand("edit", "Change a baked scene: carve, fill or paint voxels, cut or move its sources, or undo");
  auto arguments = std::make_shared<EditArguments>();
  command->add_option("SCENE", arguments->scene, "folder of a bake, or its scene.xml")->required();
  arguments->edits.add_to(*command);
  command->add_flag("--undo", arguments->undo, "remove the last edit");
  command->add_flag("--list", arguments->list, "only print the edits, in their order");
  command->add_option("--threads", arguments->threads, "threads of each rank (the host's cores shared by its ranks)");
  command->add_option("--ranks", arguments->ranks,
                      "ranks to start on this host with mpirun (one per GPU; 1 without GPUs, in a batch job, or if "
                      "mpirun starts gigabake)");
  command->add_flag("--json", arguments->json, "print the answer as JSON");
  command->add_flag("-q,--quiet", arguments->quiet, "print only errors, warnings and missing inputs");
  command->callback([arguments, &exit_code] {
    check(*arguments);
    if (arguments->list) {
      exit_code = print_list(*arguments, scene_argument(arguments->scene).parent_path());
      return;
    }
    BakeOptions start;
    start.ranks = arguments->ranks;
    start.quiet = arguments->quiet;
    if (const std::optional<int> ranks = ranks_to_start(start)) {
      exit_code = run_on_ranks(start, *ranks);
      return;
    }
    install_drain_handlers();  // before MPI starts, because mpirun passes signals on from the beginning
    exit_code = on_all_ranks("edit", [&](MpiSession& mpi) { return run(*arguments, mpi); });
  });
}

}  // namespace gigabake::app
