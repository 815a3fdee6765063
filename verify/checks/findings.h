#pragma once
/// \file What verification finds wrong, as a small scene file that shows it again.

#include <string>
#include <vector>

#include "core/isa.h"
#include "core/ray.h"
#include "render/scene.h"
#include "verify/checks/changes.h"
#include "verify/checks/csg.h"
#include "verify/checks/exact.h"
#include "verify/checks/kernels.h"
#include "verify/checks/meshes.h"
#include "verify/checks/scenes.h"
#include "verify/checks/trace_scenes.h"

namespace oktett {

struct Finding {
  std::string what;    ///< what is wrong
  std::string repeat;  ///< the check that found it and its numbers, e.g. "surface torus 12"
  Scene scene;         ///< without objects if the check's shape is none of a scene
  RayBatch rays;       ///< through the scene
};

// What a tally with a failure stands for.
Finding finding_of(KernelId id, CaseClass c, const KernelTally& tally);
Finding finding_of(std::size_t form, const ExactTally& tally);
Finding finding_of(const CsgTally& tally);
Finding finding_of(const ChangesTally& tally);
Finding finding_of(const TraceScenesTally& tally);
/// `placement` is an index into mesh_placements(); `count` rays from number `first` on were checked.
Finding finding_of(const OracleMesh& mesh, std::size_t placement, std::uint64_t first, std::uint64_t count,
                   const MeshTally& tally);
Finding finding_of(int degree, const RootsTally& tally);
/// Of a random scene; with all of its objects and rays.
Finding finding_of(const SceneTally& tally);

/// Leaves out rays, objects and operands as long as check_scene still finds something wrong, for about
/// `seconds`. Returns whether it does at all; if not, the finding stays as it is.
bool minimize(Finding& finding, const std::vector<Isa>& isas, double seconds = 20);

/// Writes a scene file that `oktett render` reads and replay_finding runs again. Throws Error as
/// write_scene_file does.
void save_finding(const std::string& path, const Finding& finding);

/// Reads the file back. Throws Error for a file that save_finding has not written.
Finding load_finding(const std::string& path);

/// Does what the finding says once more. One line for each thing that is wrong; none if all is well.
std::vector<std::string> replay(const Finding& finding, const std::vector<Isa>& isas);

}  // namespace oktett
