#pragma once

#include "nonsmooth/node/node_problem.h"

#include "core/prefetch.h"

#include <cstdint>

namespace nsfd
{
  /**
   * The groups of a node as points that hold, U = 0, leave them: those that
   * such points link move as one, with the sum of their masses. What a point
   * holds follows from the momentum of the groups; where points close a cycle,
   * they share it so that the sum of P^2 / w is least, w the reduced mass of
   * the two groups of a point: P = w (phi_2 - phi_1), with one phi per group.
   */
  template <int dim>
  class MergedGroups
  {
  public:
    using Vector = std::array<double, dim>;

    static constexpr std::size_t most = 80; ///< groups of a node

    /** @p holds by point of @p node. */
    void reinit(const NodeProblem<dim> &node,
                const std::vector<std::uint8_t> &holds);

    std::size_t size() const { return inverse_mass_.size(); }
    /** It is asked soon. */
    void prefetch() const
    {
      nsfd::prefetch(groups_);
      nsfd::prefetch(inverse_mass_);
      nsfd::prefetch(carried_);
    }
    /** Where @p group of the node is; -1 stays. */
    int of(const int group) const
    {
      return group < 0 ? group : groups_[std::size_t(group)].of;
    }
    /** Of every merged group and axis, as in NodeProblem. */
    const std::vector<Vector> &inverse_mass() const { return inverse_mass_; }

    /**
     * Means of @p velocity of the groups of the node, to size() vectors. False
     * where two prescribed motions that are held together differ.
     */
    bool merge(const std::vector<Vector> &velocity, Vector *merged) const;

    /** There are points that hold it. */
    bool is_held(const std::size_t group) const { return groups_[group].held; }
    /** m of a group along axis @p c, 0 where its motion is prescribed. */
    double mass(const std::size_t group, const unsigned int c) const
    {
      return groups_[group].mass[c];
    }
    /**
     * The impulse of the holding point number @p held, in the order of the
     * node and in axes of space, of the change of momentum of every group less
     * what its other points give, @p change.
     */
    Vector carried(std::size_t held, const Vector *change) const;

  private:
    struct Group {
      int of;       ///< merged
      bool held;    ///< there are points that hold it
      Vector mass;  ///< 0 where the motion is prescribed
      Vector share; ///< of the motion of those merged
    };
    std::vector<Group> groups_; ///< of the node
    std::vector<Vector> inverse_mass_;
    bool may_differ_ = false;     ///< prescribed motions
    std::vector<Vector> carried_; ///< by holding point and group

    void merge_masses(const NodeProblem<dim> &node,
                      const std::vector<std::uint8_t> &on_ground);
    void set_carried(const NodeProblem<dim> &node,
                     const std::vector<std::uint8_t> &holds);
  };

  /** H v of a point between merged @p groups, with @p velocity by group. */
  template <int dim>
  std::array<double, dim> jump_velocity(const double *frame,
                                        const std::array<int, 2> &groups,
                                        const std::array<double, dim> *velocity)
  {
    double v[dim];
    for (unsigned int c = 0; c < dim; ++c)
      v[c] = (groups[1] >= 0 ? velocity[groups[1]][c] : 0.) -
             (groups[0] >= 0 ? velocity[groups[0]][c] : 0.);
    std::array<double, dim> U;
    for (unsigned int r = 0; r < dim; ++r) {
      U[r] = frame[r * dim] * v[0];
      for (unsigned int c = 1; c < dim; ++c)
        U[r] += frame[r * dim + c] * v[c];
    }
    return U;
  }
} // namespace nsfd
