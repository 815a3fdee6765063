#include <optional>

#include "app/command_line.h"
#include "app/process.h"

namespace oktett {
namespace {

int run(int argc, char** argv) {
  CommandLine line(argc, argv);
  add_render_command(line);
  add_view_command(line);
  add_info_command(line);
  add_check_command(line);
  add_convert_command(line);
  add_merge_command(line);
  add_verify_command(line);
  add_examples_command(line);
  add_embree_command(line);
  add_description_commands(line);
  if (const std::optional<int> status = line.parse()) return *status;
  return line.run();
}

int run_or_report(int argc, char** argv) {
  try {
    start_tasks();
    return run(argc, argv);
  } catch (...) {
    return report_current_exception();
  }
}

}  // namespace
}  // namespace oktett

int main(int argc, char** argv) {
  oktett::prepare_process();
  return oktett::finish_output(oktett::run_or_report(argc, argv));
}
