#pragma once

#include "delassus_operator.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace nsfd
{
  /**
   * Bodies that are joined at bonded points, which have no row in W: two bodies
   * share the nodes of a face that is bonded all over, and where one is smaller
   * or the other one rigid its nodes follow that one.
   */
  template <int dim>
  class JoinedDelassus : public DelassusOperator<dim>
  {
  public:
    JoinedDelassus(const Communicator &communicator, const Bodies &bodies,
                   const InterfacePoints<dim> &points);

    /**
     * From now on these points are bonded (one per point, not zero: bonded).
     * Nothing happens if they were, and false is returned. Those of faces
     * without common nodes join nothing: see sharing(). Collective.
     */
    bool set_bonds(const std::vector<std::uint8_t> &bonded);

    /**
     * By face: bodies share its nodes once @p bonded are all bonds. They do not
     * where a part of the face is open, and where nodes would follow two
     * motions that differ: what joins them there has rows. Collective.
     */
    virtual std::vector<char>
    sharing(const std::vector<std::uint8_t> &bonded) = 0;
    /** By face: bodies share the nodes of it. */
    const std::vector<char> &shares_nodes() const { return shares_nodes_; }

    /**
     * The motion @p x to the nearest one, in the norm of the mass, in which
     * bodies that share nodes move together. True if it has changed.
     * Collective.
     */
    virtual bool join_motion(std::vector<double> &x) = 0;

    /**
     * By face: its sides can part once @p bonded are all bonds that are left.
     * Collective.
     */
    virtual std::vector<char>
    opens_with(const std::vector<std::uint8_t> &bonded) = 0;

    /**
     * Of the components that are prescribed at points (bit c of @p masks), each
     * of a node once: by the first point, in an order that all ranks know, that
     * says it. Collective.
     */
    virtual std::vector<std::uint8_t>
    once_per_node(const std::vector<std::uint8_t> &masks) = 0;

    void serialize(Archive &archive) override;

  protected:
    /** Other points are bonded now. */
    virtual void bonds_changed() = 0;

    std::vector<std::uint8_t> bonded_; ///< per point
    std::vector<char> shares_nodes_;   ///< by face
  };

  /**
   * M_hat of the motions of the nodes has a factor or is inverted by
   * iterations. @p solver and @p coordinates as in make_assembled_delassus();
   * @p faces are those that stay as they are.
   */
  template <int dim>
  std::unique_ptr<JoinedDelassus<dim>> make_joined_delassus(
      const Communicator &communicator, const Bodies &bodies,
      const InterfacePoints<dim> &points, const std::string &solver,
      const std::vector<double> &coordinates, FixedFaces faces);
} // namespace nsfd
