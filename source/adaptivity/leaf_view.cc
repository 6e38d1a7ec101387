#include "leaf_view.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace nsfd
{
  LeafView::LeafView(const Bisection &cells, const unsigned int deepest)
  {
    for (unsigned int k = 0; k < cells.cells().size(); ++k) {
      const auto &cell = cells.cells()[k];
      if (cell.level >= deepest)
        continue;
      cell_.push_back(k);
      Body &body = bodies_.emplace_back();
      for (const unsigned int v : cell.vertices)
        for (unsigned int c = 0; c < 2; ++c)
          body.centre[c] += cells.vertex(v)[c] / 3.;
      body.size = cells.longest_edge(cell);
      body.level = cell.level / 2; // which halve the size
      body.largest = std::ldexp(body.size, int(body.level));
    }
  }

  double LeafView::sum(const std::vector<double> &terms) const
  {
    return std::accumulate(terms.begin(), terms.end(), 0.);
  }

  const std::vector<double> &LeafView::none() const
  {
    throw std::logic_error("an indicator of points asks for more of a state");
  }
} // namespace nsfd
