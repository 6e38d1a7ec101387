#pragma once

#include "discretization/bodies.h"

#include <vector>

namespace nsfd
{
  /**
   * Products of bodies that share nodes with values at the nodes, class by
   * class: where few classes have all bodies, their blocks stay in the cache,
   * and no matrix of the nodes is read or kept.
   */
  class BodyProducts
  {
  public:
    /**
     * Of @p bodies, which stay where they are; unknown i of them is one of
     * @p size of node @p nodes[i]. Used only if @p pays and the blocks fit.
     */
    void set(const Bodies &bodies, const std::vector<int> &nodes,
             unsigned int size, bool pays);
    bool is_used() const { return nodes_ != nullptr; }
    /** M_hat of a step, from now on. */
    void set_step(const StepShares &shares);
    /** The block of M_hat of a class; without rows before set_step(). */
    const Block &step(std::size_t index) const;

    /** y = A x, values at nodes. */
    void apply(Block BodyClass::*block, const std::vector<double> &x,
               std::vector<double> &y) const;
    /** The same with M_hat. */
    void apply_step(const std::vector<double> &x, std::vector<double> &y) const;

  private:
    template <unsigned int size, typename Select>
    void multiply_nodes(const Select &select, const std::vector<double> &x,
                        std::vector<double> &y) const;
    template <typename Select>
    void multiply(const Select &select, const std::vector<double> &x,
                  std::vector<double> &y) const;

    const Bodies *bodies_ = nullptr;
    const std::vector<int> *nodes_ = nullptr;
    unsigned int size_ = 1;
    std::vector<Block> step_; ///< by class
  };
} // namespace nsfd
