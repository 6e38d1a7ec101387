#pragma once

#include "body_layout.h"
#include "surface_cells.h"

#include "core/communicator.h"

#include <vector>

namespace nsfd
{
  /** Where nodes of surfaces of all ranks are, and how fast. */
  template <int dim>
  class SurfaceMotion
  {
  public:
    using Vector = dealii::Tensor<1, dim>;

    SurfaceMotion(const BodyTable &table, const BodyLayout<dim> &bodies,
                  const Communicator &communicator,
                  const SurfaceCells<dim> &cells)
        : table_(table), bodies_(bodies), all_(communicator), cells_(cells)
    {
    }

    /** Follows these @p nodes of SurfaceCells from now on, in any order and
        perhaps twice. Collective. */
    void set_nodes(std::vector<std::size_t> nodes);
    /** Where they are in @p state, which positions() and velocity() then say.
        Collective. */
    void share(const State &state);

    /** Of vertices, dim each: nodes, then centres of rigid bodies. */
    const double *positions() const { return x_.data(); }
    /** Theirs in another state, say at the end of the step. Collective. */
    std::vector<double> places_in(const State &state) const;
    /** Of a node, at rest: dim coordinates. */
    const double *rest(const std::size_t node) const
    {
      return &rest_[node * dim];
    }
    Vector velocity(const std::size_t node) const { return at(v_, node); }
    /** How far it went in the last step, m: an impact within the step changes
        the velocity, which is that of its end only. */
    Vector last_way(const std::size_t node) const { return at(way_, node); }

  private:
    void share_rest();
    static Vector at(const std::vector<double> &values, std::size_t node);

    const BodyTable &table_;
    const BodyLayout<dim> &bodies_;
    const Communicator &all_;
    const SurfaceCells<dim> &cells_;
    std::vector<std::size_t> nodes_, own_nodes_;
    std::vector<double> x_, v_, way_; ///< of them by node, and centres
    std::vector<double> rest_;        ///< by node
  };
} // namespace nsfd
