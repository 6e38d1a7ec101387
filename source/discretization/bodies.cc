#include "bodies.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  Block::Block(const unsigned int rows_, const unsigned int cols_)
      : rows(rows_), cols(cols_), values(std::size_t(padded(rows_)) * cols_, 0.)
  {
  }

  Block Block::transposed() const
  {
    Block result(cols, rows);
    for (unsigned int c = 0; c < cols; ++c)
      for (unsigned int r = 0; r < rows; ++r)
        result(c, r) = (*this)(r, c);
    return result;
  }

  Block product(const Block &A, const Block &B)
  {
    Block C(A.rows, B.cols);
    for (unsigned int j = 0; j < B.cols; ++j)
      for (unsigned int k = 0; k < A.cols; ++k) {
        const double b = B(k, j);
        if (b != 0.)
          for (unsigned int i = 0; i < A.rows; ++i)
            C(i, j) += A(i, k) * b;
      }
    return C;
  }

  Block cholesky(const Block &A)
  {
    const unsigned int n = A.rows;
    Block L(n, n);
    for (unsigned int j = 0; j < n; ++j) {
      double diagonal = A(j, j);
      for (unsigned int k = 0; k < j; ++k)
        diagonal -= L(j, k) * L(j, k);
      if (!(diagonal > 0.))
        throw std::runtime_error("a body's iteration matrix is not positive "
                                 "definite: check density and moduli");
      L(j, j) = std::sqrt(diagonal);
      for (unsigned int i = j + 1; i < n; ++i) {
        double value = A(i, j);
        for (unsigned int k = 0; k < j; ++k)
          value -= L(i, k) * L(j, k);
        L(i, j) = value / L(j, j);
      }
    }
    return L;
  }

  Block forward_solve(const Block &L, Block B)
  {
    for (unsigned int j = 0; j < B.cols; ++j)
      for (unsigned int i = 0; i < B.rows; ++i) {
        const double value = B(i, j) / L(i, i);
        B(i, j) = value;
        for (unsigned int k = i + 1; k < B.rows; ++k)
          B(k, j) -= L(k, i) * value;
      }
    return B;
  }

  Block gram(const Block &A)
  {
    Block G(A.cols, A.cols);
    for (unsigned int j = 0; j < A.cols; ++j)
      for (unsigned int i = 0; i <= j; ++i) {
        double value = 0.;
        for (unsigned int k = 0; k < A.rows; ++k)
          value += A(k, i) * A(k, j);
        G(i, j) = G(j, i) = value;
      }
    return G;
  }

  template <int dim>
  std::vector<double> InterfacePoints<dim>::frames_of_points() const
  {
    if (!frame_of_face)
      return frames;
    std::vector<double> all;
    all.reserve(n_points * dim * dim);
    for (std::size_t i = 0; i < n_points; ++i)
      all.insert(all.end(), axes(i), axes(i) + dim * dim);
    return all;
  }

  template <int dim>
  std::vector<char> shared_bodies(const Bodies &bodies,
                                  const InterfacePoints<dim> &points)
  {
    std::vector<char> waited_for(points.n_points + 1, 0);
    for (const auto &neighbor : points.neighbors)
      for (const unsigned int p : neighbor.points)
        waited_for[p] = 1;
    std::vector<char> result(bodies.size(), 0);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (std::size_t s = bodies.first_slot[b]; s < bodies.first_slot[b + 1];
           ++s)
        if (waited_for[bodies.slot_point[s]])
          result[b] = 1;
    for (const auto &[slot, point] : bodies.extra_points)
      if (waited_for[point])
        result[std::upper_bound(bodies.first_slot.begin(),
                                bodies.first_slot.end(), slot) -
               bodies.first_slot.begin() - 1] = 1;
    return result;
  }

  template <int dim>
  BodyOrder shared_first(const Bodies &bodies,
                         const InterfacePoints<dim> &points)
  {
    const std::vector<char> shared = shared_bodies(bodies, points);
    BodyOrder order;
    for (const BodyClass &body : bodies.classes) {
      auto &members = order.classes.emplace_back();
      members.bodies = body.bodies;
      members.n_shared = std::size_t(
          std::stable_partition(
              members.bodies.begin(), members.bodies.end(),
              [&](const unsigned int b) { return shared[b] != 0; }) -
          members.bodies.begin());
    }
    return order;
  }

  template struct InterfacePoints<2>;
  template struct InterfacePoints<3>;
  template std::vector<char> shared_bodies(const Bodies &,
                                           const InterfacePoints<2> &);
  template std::vector<char> shared_bodies(const Bodies &,
                                           const InterfacePoints<3> &);
  template BodyOrder shared_first(const Bodies &, const InterfacePoints<2> &);
  template BodyOrder shared_first(const Bodies &, const InterfacePoints<3> &);
} // namespace nsfd
