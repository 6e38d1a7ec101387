#pragma once

#include "cell_forces.h"
#include "tensor_kernels.h"

#include <deal.II/base/aligned_vector.h>

#include <map>
#include <utility>

namespace nsfd
{
  template <int dim>
  struct BodyShape;

  /**
   * Isotropic quads and hexes of any degree, `lanes` of them at a time, by sums
   * over one direction after the other: (degree + 1)^(dim + 1) operations and
   * no matrix. A block has cells of one kind, affine or not: to the last bit
   * no cell depends on the others in its block. Tractions are computed where a
   * bound of the stress comes near the strength of a face.
   */
  template <int dim>
  class TensorForces final : public CellForces<dim>
  {
  public:
    TensorForces(const Discretization<dim> &discretization,
                 const JoinedMesh<dim> &mesh, FrontViscosity front);

    void set_forces(CornerGroups<dim> &groups) override;
    std::array<double, dim>
    corner_force(std::size_t corner,
                 const CornerGroups<dim> &groups) const override;
    void
    squared_tractions(const StrengthSites<dim> &sites,
                      typename StrengthSites<dim>::Near &near) const override;
    std::array<double, dim> traction(const StrengthSites<dim> &sites,
                                     std::size_t site) const override;

    /** All cells are such. */
    static bool fits(const Discretization<dim> &discretization);

  private:
    using Numbers = dealii::AlignedVector<double>;
    static constexpr std::size_t per_map = ((1u << dim) - 1) * dim * lanes;

    std::vector<char> find_affine() const;
    void divide(const std::vector<char> &affine);
    void set_blocks();
    double distortion(const BodyShape<dim> &shape) const;
    void set_places(const JoinedMesh<dim> &mesh);
    TensorBlock block(std::size_t index) const;
    std::uint16_t place_in_faces(unsigned int node, unsigned int face) const;
    /** At the nodes of the faces of a cell, dim components each. */
    const double *tractions(std::size_t cell) const;

    const Discretization<dim> &discretization_;
    const TensorLine line_;
    const TensorKernels kernels_;
    std::size_t n_cells_;
    unsigned int n_nodes_; ///< of a cell
    Numbers maps_, moduli_;
    std::vector<char> affine_;            ///< by block
    std::vector<std::size_t> first_cell_; ///< by block, and the end
    std::vector<unsigned int> block_;     ///< by cell
    std::vector<double> volume_;
    /// which tractions of body 1 and of body 2 a point has
    struct {
      std::vector<std::array<std::uint16_t, 2>> of_point;
      /// of points at no node of body 2: those that they are between
      std::map<unsigned int, std::vector<std::pair<std::uint16_t, double>>>
          between;
    } place_;

    const CornerGroups<dim> *groups_ = nullptr; ///< of the last forces
    std::vector<double> forces_;                ///< K q by corner
    std::vector<double> bound_; ///< of the stress at the nodes of a cell, Pa
    Numbers reference_;         ///< gradients near those of a block

    // where they have been needed since the last forces
    mutable Numbers scratch_, tractions_;
    mutable std::vector<int> tractions_of_block_; ///< -1: not computed
    mutable std::vector<unsigned int> known_;     ///< blocks with tractions
  };
} // namespace nsfd
