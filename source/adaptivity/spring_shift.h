#pragma once

#include "mesh_view.h"

#include <array>
#include <cstdint>
#include <vector>

namespace nsfd
{
  /**
   * Where the springs between smaller cells put them. In a cell under a uniform
   * stress sigma that is halved, the new springs in the direction d carry
   * sigma n_d when they are open by
   *
   *   u_d = c (sigma_nn / C_N n_d + tau / C_T),   c = 2^-level of the children,
   *
   * and the springs on the faces of the cell, stiffer now, close by u_d / 2:
   * the children move apart by u_d / 2 along either side, and all tractions
   * stay. With springs that keep the modulus of the body only. A child with a
   * face that is held or joined otherwise stays, none moves against a broken
   * or closed one. In compression unilateral springs stay closed.
   */
  template <int dim>
  class SpringShift
  {
  public:
    SpringShift(const SceneInput &input, const MeshState<dim> &mesh);

    /** dim numbers per child, m. */
    using Translations = std::vector<double>;

    /** Of the children of the cell @p body, which will have @p level. */
    Translations of_children(unsigned int body, int level) const;

    /** Of the children @p bodies of one cell, which have @p level. */
    Translations of_family(const std::vector<unsigned int> &bodies,
                           int level) const;

  private:
    using Stress = std::array<double, 6>;
    using Openings = std::array<std::array<double, dim>, dim>;
    Openings openings(unsigned int body, int block, const Stress &stress,
                      int level) const;
    /** Towards the upper or lower face in the direction d of its parent. */
    void move_apart(const Openings &openings, unsigned int child,
                    std::uint8_t held, std::uint8_t broken,
                    double *translation) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    std::vector<Stress> stress_; ///< mean, per body; empty: no springs
    std::vector<std::uint8_t> held_, broken_; ///< per body, bit f: face f
  };

  /** A child of a cube lies on face f of its parent with its own face f. */
  inline bool lies_on_face(const unsigned int child, const unsigned int face_no)
  {
    return (child >> (face_no / 2) & 1u) == (face_no & 1u);
  }
} // namespace nsfd
