#include "app/verify_endless.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "app/json.h"
#include "app/text.h"
#include "core/error.h"
#include "verify/checks/endless.h"
#include "verify/checks/findings.h"

namespace oktett {
namespace {

std::string sets_text(const std::vector<Isa>& isas) {
  std::string out;
  for (const Isa isa : isas) out += (out.empty() ? "" : " ") + std::string(to_string(isa));
  return out;
}

void print_table(const Coverage& coverage, std::uint64_t seed, const std::vector<Isa>& isas) {
  fmt::print("{:<14}{:<20}{:>12}{:>14}{:>16}{:>8}\n", "checked", "counted in", "covered", "cases", "rays",
             "wrong");
  for (const CoverageRow& row : coverage.rows)
    fmt::print("{:<14}{:<20}{:>12}{:>14}{:>16}{:>8}\n", row.family, row.unit,
               fmt::format("{} of {}", row.covered, row.of), row.cases, row.rays, row.wrong);
  fmt::print("\n{} rays in {:.1f} s, {} whole rounds, seed {}, instruction sets {}: {}\n", coverage.rays(),
             coverage.seconds, coverage.rounds, seed, sets_text(isas),
             coverage.wrong() == 0 ? "all is well" : fmt::format("{} checks FAILED", coverage.wrong()));
}

void print_json(const Coverage& coverage, std::uint64_t seed, const std::vector<Isa>& isas) {
  JsonObject all;
  all.add("passed", coverage.wrong() == 0), all.add("seed", seed), all.add("isas", sets_text(isas));
  all.add("rays", coverage.rays()), all.add("rounds", coverage.rounds);
  all.add("seconds", coverage.seconds);
  for (const CoverageRow& row : coverage.rows) {
    JsonObject json;
    json.add("covered", std::uint64_t{row.covered}), json.add("of", std::uint64_t{row.of});
    json.add("cases", row.cases), json.add("rays", row.rays), json.add("wrong", row.wrong);
    all.add(row.family, json);
  }
  fmt::print("{}\n", all.text());
}

}  // namespace

bool run_endless(const EndlessArguments& arguments, const std::vector<Isa>& isas) {
  EndlessOptions options;
  options.seconds = 3600 * parse_amount("--hours", arguments.hours, "hours", 1e-6, 1e6);
  options.seed = arguments.seed, options.isas = isas, options.folder = arguments.findings;
  if (!std::filesystem::is_directory(options.folder))
    throw Error(Location{options.folder, 0, 0}, "no such folder for findings", ErrorKind::io);
  EndlessReport report;
  report.progress = [&](const Coverage& c) {
    say("oktett: {:.0f} of {:.0f} min, {} rounds, {:.3g} rays, {} wrong\n", c.seconds / 60,
        options.seconds / 60, c.rounds, static_cast<double>(c.rays()), c.wrong());
  };
  report.finding = [](const std::string& path, const std::string& what) {
    say("oktett: {}: {}\n", path, what);
  };
  const Coverage coverage = verify_endless(options, report);
  arguments.json ? print_json(coverage, arguments.seed, isas) : print_table(coverage, arguments.seed, isas);
  return coverage.wrong() == 0;
}

bool run_replay(const EndlessArguments& arguments, const std::vector<Isa>& isas) {
  const Finding finding = load_finding(arguments.replay);
  const std::vector<std::string> wrong = replay(finding, isas);
  for (const std::string& line : wrong) fmt::print("{}\n", line);
  if (wrong.empty()) fmt::print("all is well; it was: {}\n", finding.what);
  return wrong.empty();
}

}  // namespace oktett
