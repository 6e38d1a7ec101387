#pragma once

#include "bulk_traction.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Bodies joined at bonded points, which have no row in W. In implicit steps
   * bodies whose face is bonded all over share their nodes, and where one is
   * smaller its nodes follow those of the other. Where that cannot be (explicit
   * bodies, rigid bodies, faces of which a part is released) the symmetric
   * interior penalty method joins them through the bulk,
   *
   *     K = sum of body stiffnesses
   *         + sum over bonded points w ( t.[v] + [u].t(v) + eta [u].[v] ),
   *
   * [u] the jump, t and eta those of BulkTraction. K is at least 31/32 of the
   * sum of body stiffnesses on every mesh, at every degree and contrast,
   * whichever points are bonded (theory.md). The damping of viscous bodies is
   * joined in the same way by their viscous stress.
   */
  template <int dim>
  class BondedDelassus : public DelassusOperator<dim>
  {
  public:
    using Operator = typename DelassusOperator<dim>::Operator;

    BondedDelassus(const Communicator &communicator, const Bodies &bodies,
                   const InterfacePoints<dim> &points);

    /**
     * From now on these points are bonded (one per point, not zero: bonded).
     * Nothing happens if they were, and false is returned. Collective. @throws
     * std::runtime_error if two rigid bodies share one.
     */
    bool set_bonds(const std::vector<std::uint8_t> &bonded);

    void apply(Operator op, const double *x, double *y) const override;

    /**
     * The motion @p x to the nearest one, in the norm of the mass, in which
     * bodies that share nodes move together. True if it has changed.
     * Collective.
     */
    virtual bool join_motion(std::vector<double> & /*x*/) { return false; }

    /** By face: bodies share the nodes of it. */
    const std::vector<char> &shares_nodes() const { return shares_nodes_; }
    /**
     * By face: its sides can part once @p bonded are all bonds that are left.
     * Collective.
     */
    virtual std::vector<char>
    opens_with(const std::vector<std::uint8_t> & /*bonded*/)
    {
      return std::vector<char>(this->points_.faces.size(), 1);
    }

    /**
     * Of the components that are prescribed at points (bit c of @p masks), each
     * of a node once: by the first point, in an order that all ranks know, that
     * says it. Collective.
     */
    virtual std::vector<std::uint8_t>
    once_per_node(const std::vector<std::uint8_t> &masks)
    {
      return masks;
    }

    void serialize(Archive &archive) override;

  protected:
    /** Other points are bonded now; all of them are in penalised_. */
    virtual void bonds_changed() {}

    const BulkTraction<dim> bulk_;
    std::vector<std::uint8_t> bonded_;    ///< per point
    std::vector<std::uint8_t> penalised_; ///< those of the interior penalty
    std::vector<char> shares_nodes_;      ///< by face

  private:
    void add_bonds(bool viscous, const double *x, double *y) const;

    std::vector<Block> traction_transposed_; ///< per class
    std::vector<Block> viscous_transposed_;  ///< the same of the viscous stress
    mutable std::vector<double> jump_, traction_, force_;
  };

  /**
   * For implicit steps: M_hat with the bonds in it has a factor or is inverted
   * by iterations. @p solver and @p coordinates as in
   * make_assembled_delassus(); without @p share_nodes the interior penalty
   * method joins all bodies.
   */
  template <int dim>
  std::unique_ptr<BondedDelassus<dim>> make_bonded_delassus(
      const Communicator &communicator, const Bodies &bodies,
      const InterfacePoints<dim> &points, const std::string &solver,
      const std::vector<double> &coordinates, bool share_nodes);

  /**
   * For explicit bodies, theta = 0, where bonds are forces of the last
   * displacement and M_hat = M: the local path.
   */
  template <int dim>
  std::unique_ptr<BondedDelassus<dim>>
  make_explicit_bonded_delassus(const Communicator &communicator,
                                const Bodies &bodies,
                                const InterfacePoints<dim> &points);
} // namespace nsfd
