#include "rigid_places.h"

#include <algorithm>

namespace nsfd
{
  namespace
  {
    /** How far a node is from the point, line or plane through the others. */
    template <int dim>
    double distance(const dealii::Point<dim> &x,
                    const std::vector<dealii::Point<dim>> &others)
    {
      dealii::Tensor<1, dim> rest = x - others[0];
      std::vector<dealii::Tensor<1, dim>> axes;
      const auto remove = [&](dealii::Tensor<1, dim> &v) {
        for (const auto &axis : axes)
          v -= (v * axis) * axis;
      };
      for (std::size_t k = 1; k < others.size(); ++k) {
        dealii::Tensor<1, dim> edge = others[k] - others[0];
        remove(edge);
        axes.push_back(edge / edge.norm());
      }
      remove(rest);
      return rest.norm();
    }
  } // namespace

  template <int dim>
  RigidPlaces<dim>::RigidPlaces(const BodyLayout<dim> &layout,
                                const Cells<dim> &cells)
  {
    for (const MovingBody &body : layout.bodies()) {
      if (!body.is_rigid() || (body.radius == 0. && body.extra_weight == 0.))
        continue;
      std::vector<std::size_t> nodes;
      for (const unsigned int cell : body.cells)
        for (std::size_t i = cells.first_node[cell];
             i < cells.first_node[cell + 1]; ++i)
          nodes.push_back(i);
      const auto place = [&](const std::size_t node) {
        return at_node<dim>(layout.rest(), node);
      };
      Place centre;
      for (unsigned int c = 0; c < dim; ++c)
        centre[c] = body.centre[c];
      // each as far as there is one from those before it
      Shares shares{};
      std::vector<Place> chosen = {centre};
      for (unsigned int k = 0; k <= dim; ++k) {
        const auto farthest = std::max_element(
            nodes.begin(), nodes.end(),
            [&](const std::size_t a, const std::size_t b) {
              return distance(place(a), chosen) < distance(place(b), chosen);
            });
        shares[k].first = *farthest;
        if (k == 0)
          chosen.clear();
        chosen.push_back(place(*farthest));
      }
      set_shares(shares, place, centre);
      centres_[body.number] = shares;
    }
  }

  template class RigidPlaces<2>;
  template class RigidPlaces<3>;
} // namespace nsfd
