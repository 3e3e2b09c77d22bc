#include "app/commands.h"
#include "app/manual/manual.h"
#include "app/process/bench_program.h"
#include "app/process/run_program.h"

int main(int argc, char** argv) {
  using namespace gigabake::app;
  return run_program(argc, argv, [argc, argv](CLI::App& program, int& exit_code) {
    // Add the commands in the order in which --help lists them.
    add_sample(program, exit_code);
    add_plan(program, exit_code);
    add_bake(program, exit_code);
    add_edit(program, exit_code);
    add_status(program, exit_code);
    add_info(program, exit_code);
    add_verify(program, exit_code);
    add_diff(program, exit_code);
    add_export(program, exit_code);
    add_render(program, exit_code);
    add_query(program, exit_code);
    add_view(program, exit_code);
    add_serve(program, exit_code);
    add_bench_starter(program, {argv, argv + argc});
    add_completion(program);
    add_man(program);
    add_bake_process(program);
  });
}
