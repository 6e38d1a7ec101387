#include "soft_space.h"

#include "core/disjoint_sets.h"

#include <deal.II/lac/lapack_templates.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    constexpr double stiff = 5.;

    /** Columns a and b of the rows of a face are opposite. */
    bool opposite(const FaceRows &face, const std::size_t a,
                  const std::size_t b, const double largest)
    {
      const std::size_t n = face.dofs.size();
      for (std::size_t k = 0; k < face.rows.size(); k += n)
        if (std::abs(face.rows[k + a] + face.rows[k + b]) > 1e-9 * largest)
          return false;
      return true;
    }
  } // namespace

  SoftSpace::SoftSpace(const unsigned int dim,
                       const std::vector<std::size_t> &first_dof,
                       const std::vector<FaceRows> &faces)
      : node_of_(first_dof.back(), -1), place_(first_dof.back())
  {
    DisjointSets sets(first_dof.back());
    std::vector<int> body(first_dof.back());
    for (std::size_t b = 0; b + 1 < first_dof.size(); ++b)
      for (std::size_t i = first_dof[b]; i < first_dof[b + 1]; ++i) {
        body[i] = int(b);
        // components of a node follow one another
        sets.join(unsigned(i), unsigned(i - (i - first_dof[b]) % dim));
      }
    for (const FaceRows &face : faces) {
      double largest = 0.;
      for (const double value : face.rows)
        largest = std::max(largest, std::abs(value));
      for (std::size_t a = 0; a < face.dofs.size(); ++a)
        for (std::size_t b = a + 1; b < face.dofs.size(); ++b)
          if (body[face.dofs[a]] != body[face.dofs[b]] &&
              opposite(face, a, b, largest))
            sets.join(unsigned(face.dofs[a]), unsigned(face.dofs[b]));
    }
    for (std::size_t i = 0; i < node_of_.size(); ++i) {
      const int name = int(sets.first(unsigned(i)));
      if (name == int(i)) {
        node_of_[i] = int(nodes_.size());
        nodes_.emplace_back();
      }
      node_of_[i] = node_of_[name];
      place_[i] = int(nodes_[node_of_[i]].size());
      nodes_[node_of_[i]].push_back(int(i));
    }
  }

  void SoftSpace::build(const SparseRows &K, const std::vector<double> &bodies)
  {
    find_motions(K, bodies);
    find_matrix(K);
  }

  /** Eigenvectors of the springs against the bodies, node by node. */
  void SoftSpace::find_motions(const SparseRows &K,
                               const std::vector<double> &bodies)
  {
    motions_.resize(nodes_.size());
    first_.assign(1, 0);
    std::vector<double> springs, inertia, value, work;
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
      const auto &unknowns = nodes_[node];
      const auto n = dealii::types::blas_int(unknowns.size());
      springs.assign(unknowns.size() * unknowns.size(), 0.);
      inertia = springs;
      for (const int i : unknowns)
        for (int k = K.start[i]; k < K.start[i + 1]; ++k) {
          const int j = K.column[k];
          if (node_of_[j] != int(node))
            continue;
          inertia[place_[i] + n * place_[j]] = bodies[k];
          const double half = 0.5 * (K.value[k] - bodies[k]);
          springs[place_[i] + n * place_[j]] += half;
          springs[place_[j] + n * place_[i]] += half;
        }
      value.resize(unknowns.size());
      work.resize(8 * unknowns.size() + 64);
      const dealii::types::blas_int type = 1, n_work = work.size();
      dealii::types::blas_int info = 0;
      dealii::sygv(&type, "V", "U", &n, springs.data(), &n, inertia.data(), &n,
                   value.data(), work.data(), &n_work, &info);
      if (info != 0)
        throw std::runtime_error("the bodies at a node have no positive mass");
      const auto soft =
          std::lower_bound(value.begin(), value.end(), stiff) - value.begin();
      motions_[node].assign(springs.begin(), springs.begin() + n * soft);
      first_.push_back(first_.back() + int(soft));
    }
  }

  void SoftSpace::find_matrix(const SparseRows &K)
  {
    matrix_.start.assign(1, 0);
    matrix_.column.clear();
    matrix_.value.clear();
    std::vector<int> near, seen(nodes_.size(), -1);
    std::vector<std::vector<double>> product; // rows of P^T K by near node
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
      const int n_rows = n_motions(node);
      const std::size_t n = nodes_[node].size();
      near.clear();
      for (const int i : nodes_[node])
        for (int k = K.start[i]; k < K.start[i + 1]; ++k) {
          const int other = node_of_[K.column[k]];
          if (seen[other] != int(node)) {
            seen[other] = int(node);
            near.push_back(other);
          }
        }
      std::sort(near.begin(), near.end());
      if (product.size() < near.size())
        product.resize(near.size());
      for (std::size_t q = 0; q < near.size(); ++q)
        product[q].assign(nodes_[near[q]].size() * n_rows, 0.);
      for (const int i : nodes_[node])
        for (int k = K.start[i]; k < K.start[i + 1]; ++k) {
          const int j = K.column[k];
          const auto q =
              std::lower_bound(near.begin(), near.end(), node_of_[j]) -
              near.begin();
          for (int r = 0; r < n_rows; ++r)
            product[q][place_[j] * n_rows + r] +=
                K.value[k] * motions_[node][r * n + place_[i]];
        }
      for (int r = 0; r < n_rows; ++r) {
        for (std::size_t q = 0; q < near.size(); ++q) {
          const std::size_t m = nodes_[near[q]].size();
          for (int c = 0; c < n_motions(near[q]); ++c) {
            double value = 0.;
            for (std::size_t a = 0; a < m; ++a)
              value +=
                  product[q][a * n_rows + r] * motions_[near[q]][c * m + a];
            matrix_.column.push_back(first_[near[q]] + c);
            matrix_.value.push_back(value);
          }
        }
        matrix_.start.push_back(int(matrix_.column.size()));
      }
    }
  }

  void SoftSpace::restrict_to(const double *r, double *c) const
  {
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
      const double *motion = motions_[node].data();
      for (int k = first_[node]; k < first_[node + 1]; ++k) {
        double value = 0.;
        for (const int i : nodes_[node])
          value += *motion++ * r[i];
        c[k] = value;
      }
    }
  }

  void SoftSpace::prolong(const double *c, double *x) const
  {
    for (std::size_t node = 0; node < nodes_.size(); ++node) {
      const double *motion = motions_[node].data();
      for (const int i : nodes_[node])
        x[i] = 0.;
      for (int k = first_[node]; k < first_[node + 1]; ++k)
        for (const int i : nodes_[node])
          x[i] += *motion++ * c[k];
    }
  }
} // namespace nsfd
