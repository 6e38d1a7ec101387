#pragma once

#include "body_layout.h"

#include <unordered_map>
#include <utility>

namespace nsfd
{
  /**
   * Places of rigid bodies as sums of some of their nodes: with
   *
   *   x = sum_i w_i x_i,  sum_i w_i = 1,
   *
   * of dim + 1 nodes the velocity there is sum_i w_i v_i, since that of a rigid
   * body is linear in the place, and forces w_i F on the nodes have the sum F
   * and its moment: a place outside of the cells, as on a ball, moves and is
   * pushed by way of nodes.
   */
  template <int dim>
  class RigidPlaces
  {
  public:
    using Place = dealii::Point<dim>;
    /// nodes of the state, and what they have in a place
    using Shares = std::array<std::pair<std::size_t, double>, dim + 1>;

    /** Of the bodies of the layout that are round, or have another mass than
        their cells. */
    RigidPlaces(const BodyLayout<dim> &layout, const Cells<dim> &cells);

    /** The centre of mass of a body of the table. */
    const Shares &centre(const unsigned int body) const
    {
      return centres_.at(body);
    }
    /** A place @p x on it where its nodes are at @p place of node. */
    template <typename PlaceOf>
    Shares at(const unsigned int body, const PlaceOf &place,
              const Place &x) const
    {
      Shares shares = centres_.at(body);
      set_shares(shares, place, x);
      return shares;
    }

  private:
    template <typename PlaceOf>
    static void set_shares(Shares &shares, const PlaceOf &place, const Place &x)
    {
      const Place origin = place(shares[0].first);
      dealii::Tensor<2, dim> edges; // columns
      for (unsigned int k = 1; k <= dim; ++k) {
        const auto edge = place(shares[k].first) - origin;
        for (unsigned int c = 0; c < dim; ++c)
          edges[c][k - 1] = edge[c];
      }
      const auto w = invert(edges) * (x - origin);
      shares[0].second = 1.;
      for (unsigned int k = 1; k <= dim; ++k) {
        shares[k].second = w[k - 1];
        shares[0].second -= w[k - 1];
      }
    }

    std::unordered_map<unsigned int, Shares>
        centres_; ///< by number in the table
  };
} // namespace nsfd
