#pragma once

#include "facet_geometry.h"

// boost/geometry includes a header that Boost itself calls deprecated.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>
#undef BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/iterator/function_output_iterator.hpp>

#include <utility>
#include <vector>

namespace nsfd
{
  template <int dim>
  using Corner = boost::geometry::model::point<double, dim,
                                               boost::geometry::cs::cartesian>;
  template <int dim>
  using Box = boost::geometry::model::box<Corner<dim>>;

  /** Boxes by their numbers, and which of them meet another box. */
  template <int dim>
  struct BoxTree {
    /// entries of a node: 8 to 16 take the same time, 32 take longer
    static constexpr std::size_t node_size = 16;

    using Entry = std::pair<Box<dim>, unsigned int>;
    boost::geometry::index::rtree<Entry,
                                  boost::geometry::index::linear<node_size>>
        tree;

    explicit BoxTree(const std::vector<Entry> &entries) : tree(entries) {}

    template <typename Visit>
    void near(const Box<dim> &box, const Visit &visit) const
    {
      tree.query(boost::geometry::index::intersects(box),
                 boost::make_function_output_iterator(
                     [&](const Entry &entry) { visit(entry); }));
    }
  };

  template <int dim>
  Corner<dim> corner(const Place<dim> &y)
  {
    if constexpr (dim == 2)
      return {y[0], y[1]};
    else
      return {y[0], y[1], y[2]};
  }

  template <int dim>
  Box<dim> box_around(Place<dim> low, Place<dim> high, const double margin)
  {
    for (int d = 0; d < dim; ++d) {
      low[d] -= margin;
      high[d] += margin;
    }
    return {corner<dim>(low), corner<dim>(high)};
  }
} // namespace nsfd
