#include "bench/peer_picture.h"

#include <memory>

#include "accel/accel.h"
#include "bench/peer_timing.h"
#include "bench/peer_trace.h"
#include "core/error.h"
#include "io/obj/obj.h"

#ifdef OKTETT_HAVE_TINYOBJLOADER
#include <tiny_obj_loader.h>
#endif

namespace oktett::bench {

#ifdef OKTETT_HAVE_TINYOBJLOADER

namespace {

struct Stages {
  double load = 0, build = 0, trace = 0;
  double total() const { return load + build + trace; }
};

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
  Stages s;
  ObjFile file;
  s.load = seconds([&] { file = load_obj(task.path); });
  std::shared_ptr<const Accel> accel;
  Geometry g;
  g.shape = MeshGeometry{&file.mesh};
  s.build = seconds([&] { accel = build_accel({g}, task.build); });
  s.trace = seconds([&] { trace(*accel, work, task.isa, task.threads, answers); });
  return s;
}

Stages with_embree(const PictureTask& task, const Workload& work, Answers& answers) {
  Stages s;
  TriangleMesh mesh;
  s.load = seconds([&] { mesh = load_with_tinyobjloader(task.path); });
  const EmbreeScene scene(mesh, 1, task.config.c_str());
  s.build = scene.build_seconds();
  s.trace = seconds([&] { trace(scene, task.mode, work, task.threads, answers); });
  return s;
}

/// Collects the stages of several rounds.
struct Series {
  std::vector<double> load, build, trace, total;
  void add(const Stages& s) {
    load.push_back(s.load), build.push_back(s.build), trace.push_back(s.trace), total.push_back(s.total());
  }
  void report(const std::string& name, Row& row) const {
    row.parts.emplace_back(name + " load", quartiles(load).median);
    row.parts.emplace_back(name + " build", quartiles(build).median);
    row.parts.emplace_back(name + " trace", quartiles(trace).median);
  }
};

}  // namespace

bool race_to_first_picture(const PictureTask& task, const PeerOptions& options, Row& row) {
  Workload work{Work::primary, "", {}, false};
  {
    const ObjFile file = load_obj(task.path);
    Box box;
    for (const Vec3f& p : file.mesh.positions) box.grow(p);
    work.rays = primary_rays(box, task.view);
  }
  Answers answers(work);
  Series ours, theirs;
  std::vector<double> ratios;
  for (Rounds rounds(options.seconds, 2, options.runs); rounds.next();) {
    on_threads(task.threads, [&] {
      ours.add(with_oktett(task, work, answers));
      theirs.add(with_embree(task, work, answers));
    });
    ratios.push_back(theirs.total.back() / ours.total.back());
  }
  row.oktett = quartiles(ours.total), row.embree = quartiles(theirs.total), row.ratio = quartiles(ratios);
  row.mode = "tinyobjloader; " + to_string(task.mode) + ", medium";
  ours.report("oktett", row), theirs.report("embree", row);
  return true;
}

#else

bool race_to_first_picture(const PictureTask&, const PeerOptions&, Row&) { return false; }

#endif

}  // namespace oktett::bench
