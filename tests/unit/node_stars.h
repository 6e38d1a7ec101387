#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>
#include <vector>

// Random stars: triangles or tetrahedra around one vertex.

namespace node_test
{
  class Random
  {
  public:
    explicit Random(const std::uint64_t seed) : engine_(seed) {}
    /** From @p a to @p b; the same numbers with every standard library. */
    double operator()(const double a = 0., const double b = 1.)
    {
      return a + (b - a) * double(engine_() >> 11) * 0x1p-53;
    }
    double log(const double a, const double b)
    {
      return a * std::pow(b / a, (*this)());
    }
    int below(const int n) { return int((*this)() * n); }

  private:
    std::mt19937_64 engine_;
  };

  template <int dim>
  using Vec = std::array<double, dim>;

  template <int dim>
  double dot(const Vec<dim> &a, const Vec<dim> &b)
  {
    double sum = 0.;
    for (int c = 0; c < dim; ++c)
      sum += a[c] * b[c];
    return sum;
  }

  template <int dim>
  Vec<dim> unit(Vec<dim> a)
  {
    const double length = std::sqrt(dot<dim>(a, a));
    for (double &x : a)
      x /= length;
    return a;
  }

  inline Vec<3> cross(const Vec<3> &a, const Vec<3> &b)
  {
    return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
             a[0] * b[1] - a[1] * b[0]}};
  }

  /** Rows n, t1, t2. */
  template <int dim>
  std::array<double, dim * dim> frame_of(const Vec<dim> &n)
  {
    if constexpr (dim == 2)
      return {{n[0], n[1], -n[1], n[0]}};
    else {
      const Vec<3> other =
          std::abs(n[0]) < 0.6 ? Vec<3>{{1., 0., 0.}} : Vec<3>{{0., 1., 0.}};
      const Vec<3> t1 = unit<3>(cross(n, other)), t2 = cross(n, t1);
      return {{n[0], n[1], n[2], t1[0], t1[1], t1[2], t2[0], t2[1], t2[2]}};
    }
  }

  /** Simplices around a vertex at the origin and the faces between them. */
  template <int dim>
  struct Star {
    struct Face {
      std::array<int, 2> cells;
      Vec<dim> normal; ///< from the first to the second
      double area;
    };
    std::vector<Face> faces;
    std::vector<Vec<dim>> centre;
    std::vector<double> volume;
  };

  inline Star<2> star2(Random &random)
  {
    Star<2> star;
    const int n = 5 + random.below(4);
    std::vector<Vec<2>> x;
    for (int i = 0; i < n; ++i) {
      const double angle = 2. * M_PI * (i + random(-0.3, 0.3)) / n;
      const double r = random(0.7, 1.3);
      x.push_back({{r * std::cos(angle), r * std::sin(angle)}});
    }
    for (int i = 0; i < n; ++i) {
      const Vec<2> &a = x[i], &b = x[(i + 1) % n];
      star.volume.push_back((a[0] * b[1] - a[1] * b[0]) / 2.);
      star.centre.push_back({{(a[0] + b[0]) / 3., (a[1] + b[1]) / 3.}});
      const double l = std::sqrt(dot<2>(a, a));
      star.faces.push_back(
          {{{(i + n - 1) % n, i}}, {{-a[1] / l, a[0] / l}}, l});
    }
    return star;
  }

  /** The tetrahedra at the middle of eight cubes, each cut into six. */
  inline Star<3> star3(Random &random)
  {
    Star<3> star;
    std::array<Vec<3>, 27> x;
    for (int v = 0; v < 27; ++v)
      for (int c = 0; c < 3; ++c)
        x[v][c] = double(v /
                             (c == 0   ? 1
                              : c == 1 ? 3
                                       : 9) %
                             3 -
                         1) +
                  (v == 13 ? 0. : random(-0.25, 0.25));
    std::vector<std::array<int, 3>> cells; // without the vertex in the middle
    for (int cube = 0; cube < 8; ++cube) {
      std::array<int, 3> order{{0, 1, 2}};
      do {
        std::array<int, 3> id{{cube % 2, cube / 2 % 2, cube / 4}};
        std::array<int, 4> v;
        for (int k = 0; k < 4; ++k) {
          v[k] = id[0] + 3 * id[1] + 9 * id[2];
          if (k < 3)
            ++id[order[k]];
        }
        std::sort(v.begin(), v.end());
        std::array<int, 3> rest;
        int n = 0;
        for (const int k : v)
          if (k != 13 && n < 3)
            rest[n++] = k;
        if (std::find(v.begin(), v.end(), 13) != v.end())
          cells.push_back(rest);
      } while (std::next_permutation(order.begin(), order.end()));
    }
    for (const auto &cell : cells) {
      Vec<3> centre{};
      for (const int v : cell)
        for (int c = 0; c < 3; ++c)
          centre[c] += x[v][c] / 4.;
      star.centre.push_back(centre);
      star.volume.push_back(
          std::abs(dot<3>(x[cell[0]], cross(x[cell[1]], x[cell[2]]))) / 6.);
    }
    for (int a = 0; a < int(cells.size()); ++a)
      for (int b = a + 1; b < int(cells.size()); ++b) {
        std::vector<int> both;
        std::set_intersection(cells[a].begin(), cells[a].end(),
                              cells[b].begin(), cells[b].end(),
                              std::back_inserter(both));
        if (both.size() != 2)
          continue;
        Vec<3> n = cross(x[both[0]], x[both[1]]);
        const double area = std::sqrt(dot<3>(n, n)) / 2.;
        n = unit<3>(n);
        if (dot<3>(n, star.centre[b]) < 0.)
          for (double &c : n)
            c = -c;
        star.faces.push_back({{{a, b}}, n, area});
      }
    return star;
  }

  template <int dim>
  Star<dim> random_star(Random &random)
  {
    if constexpr (dim == 2)
      return star2(random);
    else
      return star3(random);
  }
} // namespace node_test
