#pragma once

#include "deformable_cell.h"
#include "discretization/discretization.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /** The cells of a scene whose forces are not linear, shared by class. */
  template <int dim>
  class DeformableCells
  {
  public:
    explicit DeformableCells(const Discretization<dim> &discretization);
    ~DeformableCells();

    /** Null: it is rigid, or linear. */
    const DeformableCell<dim> *of(const unsigned int cell) const
    {
      return cells_[class_of_[cell]].get();
    }
    /** As FiniteStep has it. */
    const double *mass(const unsigned int cell) const
    {
      return masses_[class_of_[cell]].data();
    }
    std::size_t n_history() const { return first_.back(); }
    /** In an array of n_history(). */
    std::size_t first_history(const unsigned int cell) const
    {
      return first_[cell];
    }
    /** Of a scene that has never been strained. */
    std::vector<double> begin_history() const;

  private:
    const std::vector<unsigned int> &class_of_;
    std::vector<std::unique_ptr<const DeformableCell<dim>>> cells_;
    std::vector<std::vector<double>> masses_;
    std::vector<std::size_t> first_;
  };
} // namespace nsfd
