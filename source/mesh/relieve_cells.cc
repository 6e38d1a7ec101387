#include "relieve_cells.h"

#include "nsfd/core/space.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nsfd
{
  namespace
  {
    template <int dim>
    using Node = std::array<double, dim>;

    // an equilateral triangle of side 1 has heights of 0.25 once it is cut in
    // six; among those of Lloyd's the worst hundredth ends at these
    constexpr double low = .18, sine_of_small_angle = .5;

    /** 1: neither its smallest angle nor a height of its sixths is bad. */
    double quality(const std::array<Node<2>, 3> &x, const double size)
    {
      const auto &[a, b, c] = x;
      const double doubled_area =
          (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      const auto square = [](const Node<2> &p, const Node<2> &q) {
        return (q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]);
      };
      const double ab = square(a, b), bc = square(b, c), ca = square(c, a);
      const double smallest = std::min({ab, bc, ca}),
                   largest = std::max({ab, bc, ca}), sum = ab + bc + ca;
      // sides of the six: two thirds of a median, and half of a side
      const double longest = std::max(std::sqrt(2. * sum - 3. * smallest) / 3.,
                                      .5 * std::sqrt(largest));
      const double sine =
          doubled_area / std::sqrt(largest * (sum - largest - smallest));
      return std::min({1., doubled_area / 6. / longest / (low * size),
                       sine / sine_of_small_angle});
    }

    /**
     * The same of a tetrahedron by its lowest height: that of a regular one is
     * 0.82 of its side, of half of those of Lloyd's it is below 0.65; some are
     * nearly flat.
     */
    double quality(const std::array<Node<3>, 4> &x, const double size)
    {
      using namespace space;
      constexpr double low_in_space = .4;
      const Vec3 a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0],
                 d = x[2] - x[1], e = x[3] - x[1];
      const double six_volumes = dot(a, space::cross(b, c));
      double largest = 0.;
      for (const Vec3 &normal : {space::cross(a, b), space::cross(b, c),
                                 space::cross(c, a), space::cross(d, e)})
        largest = std::max(largest, norm(normal));
      return std::min(1., six_volumes / largest / (low_in_space * size));
    }

    /** Where to look for a better place. */
    template <int dim>
    std::vector<Node<dim>> directions()
    {
      std::vector<Node<dim>> result;
      for (int d = 0; d < dim; ++d)
        for (const double sign : {-1., 1.}) {
          Node<dim> direction{};
          direction[d] = sign;
          result.push_back(direction);
        }
      for (unsigned int corner = 0; corner < 1u << dim; ++corner) {
        Node<dim> direction{};
        for (int d = 0; d < dim; ++d)
          direction[d] = (corner >> d & 1u ? 1. : -1.) / std::sqrt(double(dim));
        result.push_back(direction);
      }
      return result;
    }

    template <int dim>
    class Relief
    {
    public:
      Relief(std::vector<Node<dim>> &nodes,
             const std::vector<unsigned char> &held,
             const std::vector<std::array<unsigned int, dim + 1>> &corners,
             const std::vector<double> &size)
          : nodes_(nodes), held_(held), corners_(corners), size_(size),
            start_(nodes.size() + 1, 0)
      {
        for (const auto &cell : corners_)
          for (const unsigned int v : cell)
            ++start_[v + 1];
        for (std::size_t v = 0; v < nodes.size(); ++v)
          start_[v + 1] += start_[v];
        around_.resize(start_.back());
        std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
        for (unsigned int c = 0; c < corners_.size(); ++c)
          for (const unsigned int v : corners_[c])
            around_[next[v]++] = c;
      }

      void run()
      {
        constexpr unsigned int most_rounds = 8;
        for (unsigned int round = 0; round < most_rounds; ++round) {
          bool has_moved = false;
          for (std::size_t c = 0; c < corners_.size(); ++c)
            if (quality_of(c) < 1.)
              for (const unsigned int v : corners_[c])
                has_moved = improve(v) || has_moved;
          if (!has_moved)
            return;
        }
      }

    private:
      double quality_of(const std::size_t c) const
      {
        std::array<Node<dim>, dim + 1> x;
        double size = 0.;
        for (int i = 0; i <= dim; ++i) {
          x[i] = nodes_[corners_[c][i]];
          size += size_[corners_[c][i]] / (dim + 1);
        }
        return quality(x, size);
      }

      double worst_around(const unsigned int v) const
      {
        double worst = std::numeric_limits<double>::infinity();
        for (std::size_t i = start_[v]; i < start_[v + 1]; ++i)
          worst = std::min(worst, quality_of(around_[i]));
        return worst;
      }

      /** To the best place nearby; false if that is where it is. */
      bool improve(const unsigned int v)
      {
        static const std::vector<Node<dim>> ways = directions<dim>();
        constexpr unsigned char all = (1u << dim) - 1u;
        if (held_[v] == all)
          return false;
        const double before = worst_around(v);
        double best = before;
        for (double length = .1; length > .01; length *= .5) {
          const Node<dim> from = nodes_[v];
          Node<dim> to = from;
          for (const Node<dim> &way : ways) {
            for (int d = 0; d < dim; ++d)
              if ((held_[v] >> d & 1u) == 0)
                nodes_[v][d] = from[d] + length * size_[v] * way[d];
            const double now = worst_around(v);
            if (now > best) {
              best = now;
              to = nodes_[v];
            }
          }
          nodes_[v] = to;
        }
        return best > before;
      }

      std::vector<Node<dim>> &nodes_;
      const std::vector<unsigned char> &held_;
      const std::vector<std::array<unsigned int, dim + 1>> &corners_;
      const std::vector<double> &size_;
      std::vector<std::size_t> start_;   ///< per node, into `around_`
      std::vector<unsigned int> around_; ///< cells
    };
  } // namespace

  template <int dim>
  void
  relieve_cells(std::vector<std::array<double, dim>> &nodes,
                const std::vector<unsigned char> &held,
                const std::vector<std::array<unsigned int, dim + 1>> &corners,
                const std::vector<double> &size)
  {
    Relief<dim>(nodes, held, corners, size).run();
  }

  template void
  relieve_cells<2>(std::vector<std::array<double, 2>> &,
                   const std::vector<unsigned char> &,
                   const std::vector<std::array<unsigned int, 3>> &,
                   const std::vector<double> &);
  template void
  relieve_cells<3>(std::vector<std::array<double, 3>> &,
                   const std::vector<unsigned char> &,
                   const std::vector<std::array<unsigned int, 4>> &,
                   const std::vector<double> &);
} // namespace nsfd
