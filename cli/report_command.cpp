#include "cli/report_command.h"

#include "bench/bench_folder.h"
#include "bench/cases/all_cases.h"
#include "cli/terminal_progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace smelt {

namespace {

std::string command_of(const ReportOptions& options) {
  std::string command = "./smelt report";
  for (const std::string& name : options.names) command += " " + name;
  return command + (options.quick ? " --quick" : "");
}

void print_report(ReportOptions options) {
  options.command = command_of(options);
  options.expected = bench_folder() / "expected.toml";
  {
    TerminalProgress progress;
    make_report(select(all_cases(), options.names), options, progress);
  }
  fmt::print("report    {}\n", (options.folder / "index.html").string());
  if (options.write_expected) fmt::print("expected  {}\n", options.expected.string());
}

}  // namespace

void add_report(CLI::App& app, ReportOptions& options, std::function<void()>& work) {
  CLI::App* command =
      app.add_subcommand("report", "speed against error: runs cases with known answers and writes a page");
  options.folder = "out/report";
  options.threads = std::max(1u, std::thread::hardware_concurrency());
  command->add_option("cases", options.names, "channel, say; by default all");
  CLI::Option* quick = command->add_flag("--quick", options.quick,
                                         "coarse resolutions: three minutes on two cores instead of twenty-two");
  command->add_option("--out", options.folder, "folder for index.html and the CSV behind it; by default out/report");
  command->add_option("--threads", options.threads, "runs at a time, each on one thread; by default one a core")
      ->check(CLI::Range(1u, 4096u));
  CLI::Option* check = command
                           ->add_flag("--check", options.check,
                                      "fail where an error is worse than bench/expected.toml has it by more than 10 %")
                           ->needs(quick);
  command->add_flag("--write-expected", options.write_expected, "store the errors there")
      ->needs(quick)
      ->excludes(check);
  command->callback([&options, &work] { work = [&options] { print_report(options); }; });
}

}  // namespace smelt
