#pragma once

#include "cells.h"

#include <vector>

namespace nsfd
{
  template <int dim>
  class MeshGroups;

  /** Gravity, body forces, tractions and pressures as forces at the nodes. */
  template <int dim>
  class Loads
  {
  public:
    Loads(const dealii::Triangulation<dim, dim> &triangulation,
          const MeshGroups<dim> &groups, const SceneInput &input,
          CellSet set = CellSet::own);

    bool any() const { return any_; }
    bool depend_on_time() const { return depend_on_time_; }

    /** Add those at time @p t to a nodal vector. */
    void add(const Cells<dim> &cells, double t,
             std::vector<double> &nodal) const;

  private:
    void add_volume(const Cells<dim> &cells, double t,
                    std::vector<double> &nodal) const;

    const SceneInput &input_;
    bool any_ = false, depend_on_time_ = false;
    struct LoadedFace {
      unsigned int body, face, boundary;
    };
    std::vector<LoadedFace> faces_;
  };
} // namespace nsfd
