#pragma once

#include "point_traces.h"

#include "body_products.h"
#include "linear_algebra/ghost_values.h"
#include "linear_algebra/row_sums.h"
#include "linear_algebra/spd_solver.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace nsfd
{
  template <int dim>
  class FinestSpace;
  template <int dim>
  class JoinedMotion;
  template <int dim>
  class NodeJacobi;
  template <int dim>
  class PointNodes;
  template <int dim>
  class Substructures;
  template <int dim>
  class TangentMultigrid;

  /**
   * The rows of this rank of
   *
   *     P^T ( M + f K + g C + H^T T H ) P
   *
   * in the space of bodies that share nodes, T a dim x dim block per point.
   */
  template <int dim>
  class JoinedMatrix
  {
  public:
    using Operator = typename DelassusOperator<dim>::Operator;

    /** @p first_dof of this rank among the unknowns of all. */
    JoinedMatrix(const DelassusOperator<dim> &delassus, long long first_dof);

    /** From now on bodies share the nodes of the faces that are marked.
        Collective. */
    void set_space(const CoarseSpace &space,
                   const std::vector<char> &shares_nodes);

    /** M + f K + g C of a step, M_hat, from now on. */
    void set_step(const StepShares &shares);

    /** M_hat and @p springs, the blocks T, row by row, or null. Collective. */
    const SparseRows &assemble(const double *springs);
    /**
     * y = P^T A P x of own values of the space, A mass, stiffness or damping.
     * Collective.
     */
    void apply(Operator op, const std::vector<double> &x,
               std::vector<double> &y) const;
    /** The same, A = M_hat + H^T T H; @p springs may be null. Collective. */
    void apply_step(const double *springs, const std::vector<double> &x,
                    std::vector<double> &y) const;

    /** Points that see motions of the space, ascending. */
    const std::vector<unsigned int> &parting_points() const
    {
      return sights_.points;
    }

    /**
     * The node, by a number of all ranks, that is all that a point sees: -1
     * where it sees none, or several.
     */
    long long node_of_point(std::size_t point) const;

    /** P^T H^T P, own values of the space. Collective. */
    void impulse(const double *P, std::vector<double> &own) const;
    /** U = H P x of own values @p x; 0 at points that are joined. Collective.
     */
    void velocity(const std::vector<double> &x, double *U) const;

    /** The blocks of M_hat + H^T T H at own nodes on its diagonal, row by row;
        @p springs may be null. Collective. */
    std::vector<double> diagonal_blocks(const double *springs = nullptr) const;

  private:
    friend class FinestSpace<dim>;
    friend class JoinedMotion<dim>;
    friend class NodeJacobi<dim>;
    friend class PointNodes<dim>;
    friend class Substructures<dim>;
    friend class TangentMultigrid<dim>;
    /** Consecutive unknowns of the space that are coupled alike. */
    using Block = int;
    /** What a block of unknowns contributes to the jump at a point. */
    struct Entry {
      Block block;
      /// dim x size of a block: of bodies of this rank, and of both
      std::array<double, std::size_t(dim) * dim> own, all;
    };

    Block block_of(long long number) const;
    void number_blocks(const CoarseSpace &space,
                       const std::vector<char> &shares_nodes);
    std::vector<Block> blocks_of_side(std::size_t point,
                                      unsigned int side) const;
    void set_entries(const std::vector<char> &shares_nodes);
    void set_pattern(const std::vector<char> &shares_nodes);
    std::size_t width(Block row) const;
    std::size_t place(Block row, Block column) const;
    void set_operators();
    template <typename Select>
    void add_bodies(const Select &select, std::vector<double> &values) const;
    void add_springs(const double *springs, std::vector<double> &values) const;
    void multiply(const std::vector<double> &values, const double *x) const;
    void fetch_ghosts(const std::vector<double> &own) const;
    void return_ghosts(std::vector<double> &own) const;

    const DelassusOperator<dim> &delassus_;
    const Bodies &bodies_; ///< of it
    const InterfacePoints<dim> &points_;
    const long long first_dof_;
    PointTraces traces_; ///< of points whose sides are not one node
    struct {
      std::vector<long long> numbers;
      GhostValues values; ///< what is at them
    } remote_;            ///< unknowns of bodies of other ranks

    const CoarseSpace *space_ = nullptr;
    std::vector<char> shares_nodes_; ///< by face
    BodyProducts by_bodies_;         ///< if it is in use, no entries are kept
    unsigned int size_ = 1;          ///< of a block
    int n_own_ = 0;                  ///< blocks
    std::vector<long long> ghosts_;  ///< blocks of other ranks
    struct {
      std::vector<Block> own, remote;
    } block_; ///< by unknown
    struct Sights {
      std::vector<std::size_t> first; ///< by point, and the end
      std::vector<Entry> entries;
      std::vector<unsigned int> points; ///< that see anything, ascending

      /**
       * For all pairs (row, column) of what a point with the spring @p T sees:
       * @p work (row, column, T a), a of the column, dim x @p size.
       */
      template <typename Work>
      void for_spring(const std::size_t i, const double *T,
                      const unsigned int size, const Work &work) const
      {
        if (first[i] == first[i + 1] ||
            std::all_of(T, T + dim * dim,
                        [](const double t) { return t == 0.; }))
          return;
        for (std::size_t c = first[i]; c < first[i + 1]; ++c) {
          const Entry &column = entries[c];
          double product[dim * dim] = {};
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int e = 0; e < dim; ++e)
              for (unsigned int l = 0; l < size; ++l)
                product[d * size + l] +=
                    T[d * dim + e] * column.all[e * size + l];
          for (std::size_t r = first[i]; r < first[i + 1]; ++r)
            work(entries[r], column, product);
        }
      }
      /** The same of all points. */
      template <typename Work>
      void for_springs(const double *springs, const unsigned int size,
                       const Work &work) const
      {
        for (const std::size_t i : points)
          for_spring(i, springs + i * dim * dim, size, work);
      }
      /** y += H^T T H x of values by block. */
      template <unsigned int size>
      void multiply(const double *springs, const double *x, double *y) const
      {
        for (const std::size_t i : points) {
          const Entry *const begin = &entries[first[i]], *const end =
                                                             begin +
                                                             (first[i + 1] -
                                                              first[i]);
          double U[dim] = {}, P[dim] = {};
          for (const Entry *entry = begin; entry != end; ++entry) {
            const double *in = x + std::size_t(entry->block) * size;
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int c = 0; c < size; ++c)
                U[d] += entry->all[d * size + c] * in[c];
          }
          const double *T = springs + i * dim * dim;
          for (unsigned int d = 0; d < dim; ++d)
            for (unsigned int e = 0; e < dim; ++e)
              P[d] += T[d * dim + e] * U[e];
          for (const Entry *entry = begin; entry != end; ++entry) {
            double *out = y + std::size_t(entry->block) * size;
            for (unsigned int d = 0; d < dim; ++d)
              for (unsigned int c = 0; c < size; ++c)
                out[c] += entry->own[d * size + c] * P[d];
          }
        }
      }
    } sights_; ///< what points see of the blocks
    struct {
      std::vector<std::size_t> first;
      std::vector<Block> column; ///< ascending
    } pattern_;                  ///< by block row, those of ghosts too
    struct {
      std::vector<double> mass, stiffness, damping, step;
    } operators_;           ///< by entry of the pattern; what vanishes is empty
    StepShares shares_{0.}; ///< of M_hat, operators_.step
    SparseRows matrix_;
    struct {
      std::vector<double> values;
      RowSums rows;
    } joint_; ///< of several ranks
    struct {
      GhostValues exchange;
      std::vector<double> values; ///< own ones and ghosts
    } mutable shared_;            ///< of the space
  };
} // namespace nsfd
