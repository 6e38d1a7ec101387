#pragma once

#include "nsfd/mesh/discretization.h"
#include "nsfd/time/state.h"

#include <array>
#include <vector>

namespace nsfd
{
  /** Some point of the face holds its two sides together. */
  template <int dim>
  bool carries(const State &state,
               const typename InterfacePoints<dim>::Face &face);

  /**
   * Fragments: connected components of bodies over faces that still carry
   * (some point with beta >= 1e-3, or a rigid or elastic joint). Numbered from
   * 0 by their first cell in the order of the cell centres (x, y, z), the same
   * on any number of ranks.
   */
  template <int dim>
  class Fragments
  {
  public:
    explicit Fragments(const Discretization<dim> &discretization,
                       const Communicator &communicator);

    /** Collective. Does nothing if no point has broken since the last call. */
    void update(const State &state);

    unsigned int count() const { return count_; }
    /** Fragment of each body of this rank. */
    const std::vector<unsigned int> &of_body() const { return of_body_; }

  private:
    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    double broken_area_ = -1.;
    unsigned int count_ = 0;
    std::vector<unsigned int> of_body_;

    std::vector<unsigned int> faces_; ///< counted here, between two cells
    /// on rank 0, over the cells and faces of all ranks, rank by rank
    std::vector<int> n_cells_;                       ///< per rank
    std::vector<unsigned int> order_;                ///< cells by their centres
    std::vector<std::array<unsigned int, 2>> pairs_; ///< cells of each face
  };
} // namespace nsfd
