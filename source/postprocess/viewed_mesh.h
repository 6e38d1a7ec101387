#pragma once

#include "discretization/body_shape.h"
#include "discretization/cell_sampler.h"
#include "discretization/discretization.h"

#include "mesh/mesh_builder.h"
#include "nsfd/postprocess/observable.h"

#include <array>
#include <map>
#include <optional>
#include <vector>

namespace nsfd
{
  /** Whether a point lies on an interface or an obstacle. */
  bool is_at(const SceneInput &input, PointOrigin origin,
             const NamedSurface &surface);

  /** Cells and faces of this rank by where they are, for observables. */
  template <int dim>
  class ViewedMesh
  {
  public:
    ViewedMesh(const SceneInput &input,
               const Discretization<dim> &discretization)
        : input_(input), discretization_(discretization)
    {
    }

    /** The mesh is there, or another one. */
    void find(const dealii::Triangulation<dim> &triangulation,
              const MeshGroups<dim> &groups);

    /** A slot of a body on a block of the scene. */
    struct Slot {
      unsigned int body, slot;
    };
    /** In the order of the bodies. */
    std::vector<Slot> slots_on(const NamedSurface &surface) const;
    /** Fields at the slots of a body. */
    const Sampler<dim> &slots_of(unsigned int body) const;

    /** A place in a cell, and its place in the reference cell. */
    struct CellPlace {
      unsigned int body;
      dealii::Point<dim> reference;
    };
    /** All cells that hold or touch a place. */
    std::vector<CellPlace> cells_at(const RunView::Vector &place) const;

    /** All cells that may reach into a ball. */
    std::vector<unsigned int> cells_in(const RunView::Vector &centre,
                                       double radius) const;

  private:
    void find_boundary_faces(const dealii::Triangulation<dim> &triangulation,
                             const MeshGroups<dim> &groups);
    std::optional<dealii::Point<dim>>
    reference_place(unsigned int body, const dealii::Point<dim> &x) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    std::vector<double> reach_; ///< of a body around its centre, m
    /// per boundary block: body and number of its face
    std::vector<std::vector<std::array<unsigned int, 2>>> boundary_faces_;
    mutable std::map<unsigned int, Sampler<dim>> samplers_; ///< by class
  };
} // namespace nsfd
