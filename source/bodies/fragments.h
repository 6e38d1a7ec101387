#pragma once

#include "discretization/discretization.h"
#include "state/state.h"

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
   * (some point with beta >= 1e-3, or a rigid or elastic joint). Ranks find the
   * pieces of their own bodies; the first one joins those that meet at faces
   * between ranks, and sees no others.
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

    /**
     * Fragment of each body of this rank, numbered from 0 by their first cell
     * in the order of the cell centres (x, y, z), the same on any number of
     * ranks. Collective; the first rank sorts what there is of pieces.
     */
    std::vector<unsigned int> number_bodies() const;

  private:
    void find_pieces(const State &state);
    void join_pieces(const State &state);

    const Discretization<dim> &discretization_;
    const Communicator &communicator_;
    double broken_area_ = -1.;
    unsigned int count_ = 0;

    struct Link {
      unsigned int face, body; ///< of this rank
      int other;               ///< body of this rank, or -1
    };
    std::vector<Link> links_;         ///< faces between two cells, counted here
    std::vector<unsigned int> piece_; ///< per body, from 0 on each rank
    unsigned int n_pieces_ = 0;
    unsigned long long first_piece_ = 0; ///< number among those of all ranks
    /// per piece of this rank: the one that stands for its fragment, of any
    std::vector<unsigned long long> stands_for_;
  };
} // namespace nsfd
