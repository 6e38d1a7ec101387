#include "mesh_changes.h"

#include "adaptive_mesh.h"
#include "spread_bisection.h"

namespace nsfd
{
  template <int dim>
  std::unique_ptr<MeshChanges<dim>>
  make_mesh_changes(const SceneInput &input, const Communicator &communicator,
                    Model<dim> &model)
  {
    if constexpr (dim == 2)
      if (input.adaptivity->bisects) {
        if (communicator.size() > 1)
          return std::make_unique<SpreadBisection>(input, communicator, model);
        return std::make_unique<BisectedMesh>(input, communicator, model);
      }
    return std::make_unique<AdaptiveMesh<dim>>(input, communicator, model);
  }

  template std::unique_ptr<MeshChanges<2>>
  make_mesh_changes(const SceneInput &, const Communicator &, Model<2> &);
  template std::unique_ptr<MeshChanges<3>>
  make_mesh_changes(const SceneInput &, const Communicator &, Model<3> &);
} // namespace nsfd
