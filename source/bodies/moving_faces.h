#pragma once

#include "contact_points.h"

#include "core/communicator.h"

namespace nsfd
{
  /** The faces of the mesh between moving bodies: jumps and frames of their
      points. */
  template <int dim>
  class MovingFaces
  {
  public:
    MovingFaces(const Discretization<dim> &discretization,
                const BodyLayout<dim> &layout, const Communicator &communicator)
        : discretization_(discretization), layout_(layout), all_(communicator)
    {
    }

    /** x2 - x1 of the points of the mesh, less its value at rest; Cartesian.
        Collective. */
    std::vector<double> jumps(const std::vector<double> &displacement) const;

    /**
     * Faces between two bodies turn with the mean of their crack faces: the
     * tangents are those of the mean motion, the normal is orthogonal to them.
     * @p places of the nodes. Collective.
     */
    void set_frames(const std::vector<double> &places,
                    ContactPoints<dim> &points) const;

  private:
    using Vector = dealii::Tensor<1, dim>;
    /** By side of a face: values at all points of the mesh, in a row. */
    using Sides = std::array<std::vector<double>, 2>;

    Sides tangents(const std::vector<double> &places) const;
    void share(Sides &sides, unsigned int stride) const;

    const Discretization<dim> &discretization_;
    const BodyLayout<dim> &layout_;
    const Communicator &all_;
  };
} // namespace nsfd
