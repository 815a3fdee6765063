#include "bench/peer_table.h"

#include <fmt/format.h>

#include <cstdio>

#include "bench/embree_peer.h"
#include "bench/program.h"

namespace oktett::bench {

static std::string number(double x) {
  if (x == 0) return "-";
  return x >= 1000  ? fmt::format("{:.0f}", x)
         : x >= 100 ? fmt::format("{:.1f}", x)
                    : fmt::format("{:.3g}", x);
}

static std::string view(bool inside, int resolution) {
  return resolution == 0 ? "" : fmt::format("{} {}", inside ? "in" : "out", resolution);
}

void print_header(const PeerOptions& options, const std::string& isa) {
  fmt::print(
      "Embree {}, {}, medians of at most {} rounds in {} s; ratio > 1: Oktett is faster (bytes: < 1 is "
      "smaller);\n"
      "+-: range between the quarter points of the ratio; robust: Embree's robust mode\n",
      embree_version(), isa, options.runs, options.seconds);
  fmt::print("{:<28} {:<8} {:>3} {:<22} {:>8} {:>8} {:>6} {:>5} {:>8} {:>6} {:>8}  {:<7} {}\n", "mesh",
             "view", "thr", "work", "Oktett", "Embree", "ratio", "+-", "robust", "ratio", "null", "unit",
             "modes");
}

/// Texts that are not empty, with semicolons between.
static std::string joined(std::initializer_list<std::string> texts) {
  std::string all;
  for (const std::string& text : texts)
    if (!text.empty()) all += (all.empty() ? "" : "; ") + text;
  return all;
}

void print_row(const Row& r) {
  const auto& [ordinary, robust] = r.against;
  fmt::print("{:<28} {:<8} {:>3} {:<22} {:>8} {:>8} {:>6.2f} {:>5.2f} {:>8} {:>6.2f} {:>8}  {:<7} {}\n",
             r.mesh, view(r.inside, r.resolution), r.threads, r.work, number(r.oktett.median),
             number(ordinary.embree.median), ordinary.ratio.median, ordinary.ratio.range(),
             number(robust.embree.median), robust.ratio.median, number(r.null.median), r.unit,
             joined({r.mode, ordinary.mode, robust.mode}));
  std::fflush(stdout);
}

void print_agreement(const std::vector<Agreement>& agreements) {
  if (agreements.empty()) return;
  Agreement sum;
  for (const Agreement& a : agreements) {
    sum.rays += a.rays;
    for (int k = 0; k < kRivals; ++k)
      sum.hit_or_miss[k] += a.hit_or_miss[k], sum.distance[k] += a.distance[k];
  }
  fmt::print(
      "{:<28} of {} rays, Oktett and Embree (robust) disagree on the number of hits for {} ({}), on t by "
      "more "
      "than 1e-3 for {} ({})\n",
      agreements.front().mesh, sum.rays, sum.hit_or_miss[0], sum.hit_or_miss[1], sum.distance[0],
      sum.distance[1]);
  std::fflush(stdout);
}

static std::string json(const Quartiles& q) {
  return fmt::format("{{\"median\": {}, \"low\": {}, \"high\": {}}}", q.median, q.low, q.high);
}

/// As a JSON string; the names here are printable.
static std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

static std::string json(const Row& r) {
  const auto& [ordinary, robust] = r.against;
  std::string parts;
  for (const auto& [name, value] : r.parts)
    parts += fmt::format("{}{}: {}", parts.empty() ? "" : ", ", quoted(name), value);
  return fmt::format(
      "{{\"mesh\": {}, \"view\": \"{}\", \"resolution\": {}, \"threads\": {}, \"work\": {}, \"unit\": {}, "
      "\"oktett\": {}, \"null\": {}, \"embree\": {}, \"ratio\": {}, \"mode\": {}, \"robust\": {}, "
      "\"robust_ratio\": {}, \"robust_mode\": {}, \"parts\": {{{}}}}}",
      quoted(r.mesh), r.inside ? "inside" : "outside", r.resolution, r.threads, quoted(r.work),
      quoted(r.unit), json(r.oktett), json(r.null), json(ordinary.embree), json(ordinary.ratio),
      quoted(joined({r.mode, ordinary.mode})), json(robust.embree), json(robust.ratio), quoted(robust.mode),
      parts);
}

static std::string json(const Agreement& a) {
  return fmt::format(
      "{{\"mesh\": {}, \"view\": \"{}\", \"resolution\": {}, \"work\": {}, \"rays\": {}, \"hit_or_miss\": "
      "{}, "
      "\"distance\": {}, \"robust_hit_or_miss\": {}, \"robust_distance\": {}}}",
      quoted(a.mesh), a.inside ? "inside" : "outside", a.resolution, quoted(a.work), a.rays, a.hit_or_miss[0],
      a.distance[0], a.hit_or_miss[1], a.distance[1]);
}

template <class T>
static std::string json_list(const char* name, const std::vector<T>& list) {
  std::string text = fmt::format("\"{}\": [", name);
  for (const T& item : list) text += fmt::format("{}\n  {}", &item == &list.front() ? "" : ",", json(item));
  return text + "\n]";
}

void write_json(const std::string& path, const PeerReport& report, const std::string& isa) {
  write_text(path, fmt::format("{{\"embree\": \"{}\", \"isa\": \"{}\",\n{},\n{}}}\n", embree_version(), isa,
                               json_list("rows", report.rows), json_list("agreement", report.agreements)));
}

}  // namespace oktett::bench
