#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/command_line.h"
#include "app/json.h"
#include "app/render_options.h"
#include "app/text.h"
#include "core/error.h"
#include "core/isa.h"
#include "io/mesh/load/load_mesh.h"
#include "verify/checks/changes.h"
#include "verify/checks/csg.h"
#include "verify/checks/endless.h"
#include "verify/checks/exact.h"
#include "verify/checks/findings.h"
#include "verify/checks/kernels.h"
#include "verify/checks/meshes.h"
#include "verify/checks/trace_scenes.h"

namespace oktett {

// ---- `oktett verify --hours` and `--replay`.

struct EndlessArguments {
  std::string hours;   ///< as it was typed; empty: not asked for
  std::string replay;  ///< the file of a finding; empty: not asked for
  std::string findings = ".";
  std::uint64_t seed = 1;
  bool json = false;
};

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

// Each returns true if all is well. They throw Error for bad arguments, before any work.
static bool run_endless(const EndlessArguments& arguments, const std::vector<Isa>& isas) {
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

static bool run_replay(const EndlessArguments& arguments, const std::vector<Isa>& isas) {
  const Finding finding = load_finding(arguments.replay);
  const std::vector<std::string> wrong = replay(finding, isas);
  for (const std::string& line : wrong) fmt::print("{}\n", line);
  if (wrong.empty()) fmt::print("all is well; it was: {}\n", finding.what);
  return wrong.empty();
}

namespace {

struct VerifyArguments {
  std::uint64_t rays = 0;
  std::vector<std::string> meshes;
  std::vector<std::string> surfaces;
  std::string isa;
  std::string bvh;
  bool meshes_only = false;
  EndlessArguments endless;
  bool quick = false;
  bool json = false;

  bool wants(const std::string& surface) const {
    return surfaces.empty() || std::find(surfaces.begin(), surfaces.end(), surface) != surfaces.end();
  }
};

/// The results so far: each is printed as soon as it is known, or gathered for --json.
class Report {
 public:
  explicit Report(bool json) : json_(json) {}

  void heading(const std::string& line) const {
    if (!json_) fmt::print("{}\n", line);
  }

  void kernel(KernelId id, CaseClass c, const KernelTally& t) {
    row(t, fmt::format("{} {} pair {}", to_string(id), to_string(c), t.first_failure),
        fmt::format("{:<25}{:<8}{:>10}{:>10}{:>10}{:>9}{:>10}{:>10}  {}", to_string(id), to_string(c), t.rays,
                    t.hits, t.undecided, t.wrong, t.differing, t.excess,
                    t.worst_ulps > 0 ? fmt::format("{:.3f}", t.worst_ulps) : "-"));
    JsonObject json;
    json.add("rays", t.rays), json.add("hits", t.hits), json.add("undecided", t.undecided);
    json.add("wrong", t.wrong), json.add("differing", t.differing);
    if (id == KernelId::slab) json.add("excess", t.excess);
    json.add("must_be_right", must_be_right(id, c));
    json.add("worst_ulps", t.worst_ulps);
    kernels_.add(fmt::format("{}/{}", to_string(id), to_string(c)), json);
  }

  void exact(const std::string& name, const ExactTally& t) {
    row(t, name,
        fmt::format("{:<25}{:>10}{:>10}{:>8}{:>10}{:>9}{:>9}{:>8}{:>8}{:>11}{:>9}{:>10.3f}", name, t.rays,
                    t.hits, t.missed, t.invented, t.touched, t.creased, t.off_surface, t.lists, t.differing,
                    t.uncertified, t.worst_residual));
    JsonObject json;
    json.add("rays", t.rays), json.add("hits", t.hits), json.add("missed", t.missed);
    json.add("invented", t.invented), json.add("touched", t.touched), json.add("creased", t.creased);
    json.add("off_surface", t.off_surface), json.add("lists", t.lists), json.add("differing", t.differing);
    json.add("uncertified", t.uncertified), json.add("worst_residual", t.worst_residual);
    surfaces_.add(name, json);
  }

  void mesh(const std::string& name, const MeshPlacement& p, const MeshTally& t) {
    const std::string state = t.open_edges == 0 ? "closed" : fmt::format("open: {} edges", t.open_edges);
    row(t, fmt::format("{} {} ray {}", name, p.name, t.first_failure),
        fmt::format("{:<18}{:<12}{:<20}{:>9}{:>10}{:>7}{:>8}{:>9}{:>10}{:>13}", name, p.name, state, t.rays,
                    t.hits, t.leaks, t.parity, t.doubled, t.differing, t.inconsistent));
    JsonObject json;
    json.add("open_edges", t.open_edges), json.add("rays", t.rays), json.add("hits", t.hits);
    json.add("leaks", t.leaks), json.add("parity", t.parity), json.add("doubled", t.doubled);
    json.add("differing", t.differing), json.add("inconsistent", t.inconsistent);
    meshes_.add(fmt::format("{}/{}", name, p.name), json);
  }

  void csg(const CsgTally& t) {
    row(t, "combinations",
        fmt::format("{:<25}{:>10}{:>11}{:>13}{:>8}{:>8}{:>8}{:>9}{:>11}", "random trees", t.rays, t.crossings,
                    t.samples, t.wrong_spans, t.wrong_first, t.wrong_inside, t.wrong_normal, t.differing));
    combinations_.add("rays", t.rays), combinations_.add("crossings", t.crossings);
    combinations_.add("samples", t.samples), combinations_.add("wrong_spans", t.wrong_spans);
    combinations_.add("wrong_first", t.wrong_first), combinations_.add("wrong_inside", t.wrong_inside);
    combinations_.add("wrong_normal", t.wrong_normal);
    combinations_.add("differing", t.differing);
  }

  void changes(const ChangesTally& t) {
    row(t, "changes",
        fmt::format("{:<25}{:>10}{:>10}{:>10}{:>10}{:>9}{:>9}{:>11}{:>9}", "random sequences", t.rays, t.hits,
                    t.sequences, t.changes, t.builds, t.refits, t.differing, t.altered));
    changes_.add("rays", t.rays), changes_.add("hits", t.hits), changes_.add("sequences", t.sequences);
    changes_.add("changes", t.changes), changes_.add("builds", t.builds), changes_.add("refits", t.refits);
    changes_.add("differing", t.differing), changes_.add("altered", t.altered);
  }

  void trace_scenes(const TraceScenesTally& t) {
    row(t, "trace_scene",
        fmt::format("{:<25}{:>10}{:>10}{:>10}{:>10}{:>10}{:>11}{:>11}", "random scenes", t.rays, t.hits,
                    t.scenes, t.parts, t.judged, t.differing, t.misjudged));
    trace_scenes_.add("rays", t.rays), trace_scenes_.add("hits", t.hits);
    trace_scenes_.add("scenes", t.scenes), trace_scenes_.add("parts", t.parts);
    trace_scenes_.add("judged", t.judged), trace_scenes_.add("differing", t.differing);
    trace_scenes_.add("misjudged", t.misjudged);
  }

  /// Prints the end of the report and returns the exit status.
  int finish(double seconds) const {
    if (json_) {
      JsonObject all;
      all.add("passed", failure_.empty()), all.add("failed_rows", failed_rows_), all.add("rays", rays_);
      all.add("seconds", seconds), all.add("first_failure", failure_);
      all.add("kernels", kernels_), all.add("surfaces", surfaces_), all.add("meshes", meshes_);
      all.add("combinations", combinations_), all.add("changes", changes_);
      all.add("trace_scene", trace_scenes_);
      fmt::print("{}\n", all.text());
    } else {
      fmt::print("\n{} rays in {:.1f} s: {}\n", rays_, seconds,
                 failure_.empty() ? "all is well" : fmt::format("{} rows FAILED", failed_rows_));
      if (!failure_.empty()) fmt::print("first failure: {}\n", failure_);
    }
    return failure_.empty() ? 0 : kExitInternal;
  }

 private:
  /// Prints `line`; `place` says where the tally's failure is.
  void row(const auto& tally, const std::string& place, const std::string& line) {
    heading(line);
    if (!json_) std::fflush(stdout);
    rays_ += tally.rays;
    if (tally.failure.empty()) return;
    ++failed_rows_;
    if (failure_.empty()) failure_ = place + ": " + tally.failure;
  }

  bool json_;
  JsonObject kernels_, surfaces_, meshes_, combinations_, changes_, trace_scenes_;
  std::uint64_t rays_ = 0, failed_rows_ = 0;
  std::string failure_;
};

/// The instruction sets to be tried: the one asked for, or all that this machine has.
std::vector<Isa> chosen_isas(const std::string& name) {
  if (name.empty() || name == "all") return available_isas();
  return {choose_isa(name)};
}

void verify_kernels(const VerifyArguments& arguments, std::uint64_t rays, Report& report) {
  report.heading(fmt::format("{:<25}{:<8}{:>10}{:>10}{:>10}{:>9}{:>10}{:>10}  {}", "kernel", "class", "rays",
                             "hits", "undecided", "wrong", "differing", "excess", "ulps of t"));
  for (int k = 0; k < kKernels; ++k)
    for (int c = 0; c < kCaseClasses; ++c) {
      const KernelId id = static_cast<KernelId>(k);
      const CaseClass kind = static_cast<CaseClass>(c);
      report.kernel(id, kind, verify_kernel(id, kind, rays / kCaseClasses, chosen_isas(arguments.isa)));
    }
}

void verify_surfaces(const VerifyArguments& arguments, std::uint64_t rays, Report& report) {
  const std::vector<std::string> names = exact_oracle_names();
  if (names.empty()) return;
  report.heading(fmt::format("\n{:<25}{:>10}{:>10}{:>8}{:>10}{:>9}{:>9}{:>8}{:>8}{:>11}{:>9}{:>10}",
                             "surface", "rays", "hits", "missed", "invented", "touched", "creased", "off",
                             "lists", "differing", "given up", "residual"));
  for (std::size_t form = 0; form < names.size(); ++form)
    if (arguments.wants(names[form]))
      report.exact(names[form], verify_exact(form, rays, chosen_isas(arguments.isa)));
}

/// The meshes of files, and the generated closed ones unless something else is asked for.
std::vector<OracleMesh> oracle_meshes(const VerifyArguments& arguments) {
  const bool only_files = !arguments.surfaces.empty() || (arguments.meshes_only && !arguments.meshes.empty());
  std::vector<OracleMesh> meshes;
  if (!only_files) meshes = make_closed_meshes();
  for (const std::string& file : arguments.meshes)
    meshes.push_back({std::filesystem::path(file).stem().string(),
                      load_mesh(file, {.weld = repeats_vertices(file)}).mesh, false});
  return meshes;
}

void verify_meshes(const VerifyArguments& arguments, const std::vector<OracleMesh>& meshes,
                   std::uint64_t rays, Report& report) {
  report.heading(fmt::format("\n{:<18}{:<12}{:<20}{:>9}{:>10}{:>7}{:>8}{:>9}{:>10}{:>13}", "mesh",
                             "placement", "", "rays", "hits", "leaks", "parity", "doubled", "differing",
                             "inconsistent"));
  const BuildOptions build = parse_bvh_option(arguments.bvh);
  for (const OracleMesh& mesh : meshes)
    for (const MeshPlacement& placement : mesh_placements())
      report.mesh(mesh.name, placement,
                  verify_mesh(mesh, placement, rays, chosen_isas(arguments.isa), build));
}

void verify_combinations(const VerifyArguments& arguments, std::uint64_t rays, Report& report) {
  report.heading(fmt::format("\n{:<25}{:>10}{:>11}{:>13}{:>8}{:>8}{:>8}{:>9}{:>11}", "combinations", "rays",
                             "crossings", "samples", "spans", "firsts", "inside", "normals", "differing"));
  report.csg(verify_csg(rays, chosen_isas(arguments.isa)));
}

/// A thousandth of the rays are sequences.
void verify_changes(const VerifyArguments& arguments, std::uint64_t rays, Report& report) {
  report.heading(fmt::format("\n{:<25}{:>10}{:>10}{:>10}{:>10}{:>9}{:>9}{:>11}{:>9}", "changes", "rays",
                             "hits", "sequences", "changes", "builds", "refits", "differing", "altered"));
  report.changes(verify_changes(rays / 1000 + 1, chosen_isas(arguments.isa)));
}

/// For a thousandth of the rays there is a scene.
void verify_trace_scenes(const VerifyArguments& arguments, std::uint64_t rays, Report& report) {
  report.heading(fmt::format("\n{:<25}{:>10}{:>10}{:>10}{:>10}{:>10}{:>11}{:>11}", "trace_scene", "rays",
                             "hits", "scenes", "parts", "judged", "differing", "misjudged"));
  report.trace_scenes(verify_trace_scenes(rays / 1000 + 1, chosen_isas(arguments.isa)));
}

/// Throws Error if one of the requested surfaces does not exist.
void check_surfaces(const std::vector<std::string>& asked) {
  std::vector<std::string> names = exact_oracle_names();
  names.push_back("combinations"), names.push_back("changes"), names.push_back("trace_scene");
  for (const std::string& name : asked) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw Error(
        fmt::format("--surface: unknown surface '{}'{}", name,
                    did_you_mean(name, names, fmt::format("expected one of {}", fmt::join(names, ", ")))));
  }
}

/// --hours or --replay.
int run_everything(const VerifyArguments& arguments) {
  EndlessArguments endless = arguments.endless;
  endless.json = arguments.json;
  if (arguments.rays > 0 || arguments.quick || !arguments.meshes.empty() || !arguments.surfaces.empty() ||
      !arguments.bvh.empty() || arguments.meshes_only || (!endless.hours.empty() && !endless.replay.empty()))
    throw Error("--hours and --replay go with --isa and --json, --hours also with --seed and --findings");
  const std::vector<Isa> isas = chosen_isas(arguments.isa);
  return (endless.replay.empty() ? run_endless(endless, isas) : run_replay(endless, isas)) ? 0
                                                                                           : kExitInternal;
}

int run_verify(const VerifyArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  // Complains before the work begins.
  parse_bvh_option(arguments.bvh);
  chosen_isas(arguments.isa);
  if (!arguments.endless.hours.empty() || !arguments.endless.replay.empty()) return run_everything(arguments);
  check_surfaces(arguments.surfaces);
  if (arguments.meshes_only && !arguments.surfaces.empty())
    throw Error("--meshes-only and --surface exclude each other");
  const bool all = arguments.surfaces.empty() && !arguments.meshes_only;
  const std::vector<OracleMesh> meshes = oracle_meshes(arguments);
  const std::uint64_t rays = arguments.rays > 0 ? arguments.rays : arguments.quick ? 100'000 : 10'000'000;
  Report report(arguments.json);
  if (all) verify_kernels(arguments, rays, report);
  if (!arguments.meshes_only) verify_surfaces(arguments, rays / 10, report);
  if (!meshes.empty()) verify_meshes(arguments, meshes, rays / 100 + 1, report);
  if (!arguments.meshes_only && arguments.wants("combinations"))
    verify_combinations(arguments, rays / 10, report);
  if (!arguments.meshes_only && arguments.wants("changes")) verify_changes(arguments, rays, report);
  if (!arguments.meshes_only && arguments.wants("trace_scene")) verify_trace_scenes(arguments, rays, report);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return report.finish(seconds.count());
}

}  // namespace

void add_verify_command(CommandLine& line) {
  const auto arguments = std::make_shared<VerifyArguments>();
  Verb verb = line.add_verb("verify", "Check kernels and tracing against exact arithmetic",
                            [arguments] { return run_verify(*arguments); });
  verb.option("--rays", &arguments->rays, "N",
              "Rays per kernel; a hundredth of it per mesh and placement (default 10 million)");
  verb.option("--mesh", &arguments->meshes, "FILE",
              "Check this mesh too, also beside --surface; may be repeated");
  verb.option("--surface", &arguments->surfaces, "NAME",
              "Check this exact surface, `combinations`, `changes` or `trace_scene` only; may be repeated");
  verb.flag("--meshes-only", arguments->meshes_only,
            "Check meshes only: those given, else the generated ones");
  verb.choice("--isa", arguments->isa, "NAME", "One instruction set instead of all",
              {"scalar", "sse4.2", "avx2", "avx512"});
  add_bvh_option(verb, arguments->bvh);
  verb.option("--hours", &arguments->endless.hours, "H",
              "Check new random cases of everything for so many hours; 0.1 is six minutes");
  verb.option("--seed", &arguments->endless.seed, "S", "Which cases --hours checks (default 1)");
  verb.option("--findings", &arguments->endless.findings, "DIR",
              "Where --hours saves scene files of what is wrong (default: here)");
  verb.option("--replay", &arguments->endless.replay, "FILE", "Run what such a file says again");
  verb.flag("--quick", arguments->quick, "100 000 rays per kernel");
  verb.flag("--json", arguments->json, "Print one JSON object");
  verb.footer("Exits with status 3 if anything is found wrong.");
}

}  // namespace oktett
