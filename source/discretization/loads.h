#pragma once

#include "absorbing_sides.h"
#include "initial_stress.h"
#include "state/load_clock.h"

#include <memory>
#include <vector>

namespace nsfd
{
  template <int dim>
  class MeshGroups;

  /**
   * Gravity, body forces, tractions and pressures as forces at the nodes, and
   * what else acts on cells and sides: an initial stress, absorbing sides.
   */
  template <int dim>
  class Loads
  {
  public:
    Loads(const dealii::Triangulation<dim, dim> &triangulation,
          const MeshGroups<dim> &groups, const SceneInput &input,
          CellSet set = CellSet::own);

    bool any() const { return any_; }
    bool depend_on_time() const { return depend_on_time_; }

    /** After the points are there. */
    void set_initial_stress(std::unique_ptr<const InitialStress<dim>> stress)
    {
      initial_stress_ = std::move(stress);
    }
    /** Null: there is none. */
    const InitialStress<dim> *initial_stress() const
    {
      return initial_stress_.get();
    }
    const std::vector<AbsorbingFace> &absorbing_faces() const
    {
      return absorbing_faces_;
    }
    struct LoadedFace {
      unsigned int body, face, boundary;
    };
    /** With a given temperature or heat flux. */
    const std::vector<LoadedFace> &heated_faces() const
    {
      return heated_faces_;
    }

    /** Add those at time @p t to a nodal vector; sides that @p clock has
        stopped keep theirs. */
    void add(const Cells<dim> &cells, double t, const LoadClock &clock,
             std::vector<double> &nodal) const;

  private:
    void add_volume(const Cells<dim> &cells, double t,
                    std::vector<double> &nodal) const;

    const SceneInput &input_;
    bool any_ = false, depend_on_time_ = false;
    std::vector<LoadedFace> faces_, heated_faces_;
    std::unique_ptr<const InitialStress<dim>> initial_stress_; ///< or null
    std::vector<AbsorbingFace> absorbing_faces_;
  };
} // namespace nsfd
