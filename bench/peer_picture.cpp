#include "bench/peer_picture.h"

#include <array>
#include <memory>

#include "accel/accel.h"
#include "bench/peer_timing.h"
#include "bench/peer_trace.h"
#include "core/error.h"
#include "io/mesh/load/load_mesh.h"

#ifdef OKTETT_HAVE_TINYOBJLOADER
#include <tiny_obj_loader.h>
#endif

namespace oktett::bench {

#ifdef OKTETT_HAVE_TINYOBJLOADER

namespace {

constexpr const char* kStages[] = {"load", "build", "trace"};
using Stages = std::array<double, 3>;

/// Triangles of a file as Embree takes them: only positions and their indices.
TriangleMesh load_with_tinyobjloader(const std::string& path) {
  tinyobj::ObjReader reader;
  if (!reader.ParseFromFile(path)) throw Error({path, 0, 0}, reader.Error(), ErrorKind::io);
  TriangleMesh mesh;
  const std::vector<tinyobj::real_t>& v = reader.GetAttrib().vertices;
  mesh.positions.resize_uninitialized(v.size() / 3);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    mesh.positions[i] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
  std::size_t count = 0;
  for (const tinyobj::shape_t& shape : reader.GetShapes()) count += shape.mesh.indices.size();
  mesh.indices.resize_uninitialized(count);
  count = 0;
  for (const tinyobj::shape_t& shape : reader.GetShapes())
    for (const tinyobj::index_t& index : shape.mesh.indices)
      mesh.indices[count++] = static_cast<std::uint32_t>(index.vertex_index);
  return mesh;
}

Stages with_oktett(const PictureTask& task, const Workload& work, Answers& answers) {
  MeshFile file;
  std::shared_ptr<const Accel> accel;
  return {seconds([&] { file = load_mesh(task.path); }), seconds([&] {
            accel = build_accel({{MeshGeometry{&file.mesh}, {}}}, task.build);
          }),
          seconds([&] { trace(*accel, work, task.isa, task.threads, answers); })};
}

Stages with_embree(const PictureTask& task, int rival, const Workload& work, Answers& answers) {
  PeerScene scene;
  const double load = seconds(
      [&] { scene.meshes.push_back(std::make_shared<TriangleMesh>(load_with_tinyobjloader(task.path))); });
  const EmbreeScene built(scene, {1, rival == 1}, task.config);
  return {load, built.build_seconds(),
          seconds([&] { trace(built, task.modes[rival], work, task.threads, answers); })};
}

/// Collects the stages of several rounds.
struct Series {
  std::vector<double> stage[3], total;
  void add(const Stages& s) {
    for (int k = 0; k < 3; ++k) stage[k].push_back(s[k]);
    total.push_back(s[0] + s[1] + s[2]);
  }
  void report(const std::string& name, Row& row) const {
    for (int k = 0; k < 3; ++k) row.parts.emplace_back(name + " " + kStages[k], quartiles(stage[k]).median);
  }
};

}  // namespace

bool race_to_first_picture(const PictureTask& task, const PeerOptions& options, Row& row) {
  const Workload work{Work::primary, "",
                      std::make_shared<RayBatch>(primary_rays(file_scene(task.path).bounds(), task.view))};
  Answers answers(work);
  Series ours, theirs[kRivals];
  std::vector<double> ratios[kRivals];
  for (Rounds rounds(options.seconds, 2, options.runs); rounds.next();) {
    on_threads(task.threads, [&] {
      ours.add(with_oktett(task, work, answers));
      for (int k = 0; k < kRivals; ++k) {
        theirs[k].add(with_embree(task, k, work, answers));
        ratios[k].push_back(theirs[k].total.back() / ours.total.back());
      }
    });
  }
  row.oktett = quartiles(ours.total), row.mode = "tinyobjloader";
  ours.report("oktett", row);
  for (int k = 0; k < kRivals; ++k) {
    row.against[k] = {quartiles(theirs[k].total), quartiles(ratios[k]),
                      to_string(task.modes[k]) + ", medium"};
    theirs[k].report(k == 0 ? "embree" : "robust", row);
  }
  return true;
}

#else

bool race_to_first_picture(const PictureTask&, const PeerOptions&, Row&) { return false; }

#endif

}  // namespace oktett::bench
