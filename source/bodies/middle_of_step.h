#pragma once

#include "contact_points.h"
#include "row_geometry.h"
#include "step_motion.h"

#include "core/communicator.h"

namespace nsfd
{
  /**
   * The bodies at the middle of the motion of a step: where their nodes and
   * contacts are, frames of the contacts and traces of the bodies. There a
   * point moves by exactly h H v_theta.
   */
  template <int dim>
  class MiddleOfStep
  {
  public:
    using Vector = dealii::Tensor<1, dim>;
    using Place = dealii::Point<dim>;

    /** Of @p motion as it will be; @p points and the traces of @p bodies are
        set here. */
    MiddleOfStep(const SceneInput &input,
                 const Discretization<dim> &discretization,
                 const BodyLayout<dim> &layout,
                 const Communicator &communicator, const StepMotion &motion,
                 ContactPoints<dim> &points, Bodies &bodies);

    void set_nodes();
    const std::vector<double> &nodes() const { return nodes_; }
    Place node_place(const std::size_t i) const
    {
      return at_node<dim>(nodes_, i);
    }
    /** Of a rigid body. */
    Place centre(std::size_t body) const;

    /** Places, frames and traces of the contacts. Collective. */
    void place_rows();

  private:
    Place pin(std::size_t body, unsigned int pin) const;
    void set_own_ends(std::size_t row);
    void share_ends();
    void set_row(std::size_t row);
    void set_traces(std::size_t row, const Place &x);
    Place in_reference_cell(unsigned int cell, const std::size_t *nodes,
                            const double *weights, unsigned int n_nodes,
                            const Place &x) const;
    void set_deformable_trace(std::size_t body, unsigned int slot,
                              const Place &place);

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const BodyLayout<dim> &layout_;
    const Communicator &all_;
    const StepMotion &motion_;
    ContactPoints<dim> &points_;
    Bodies &bodies_;
    std::vector<double> nodes_;
    std::vector<RowEnds<dim>> row_ends_;
  };
} // namespace nsfd
