#pragma once

#include "discretization/discretization.h"
#include "nsfd/materials/history_material.h"

#include <memory>
#include <vector>

namespace nsfd
{
  /** What the points of cells keep, as numbers. */
  class KeptHistories
  {
  public:
    virtual ~KeptHistories() = default;

    /** Cell by cell, point by point of the cell quadrature. */
    const std::vector<double> &values() const { return now_; }
    /** Of a scene that has never been strained. */
    virtual std::vector<double> at_rest() const = 0;
    /** Of a state that a step of length @p last has led to: places beside the
        points flow as in that step. */
    void set(const std::vector<double> &values, const double last)
    {
      now_ = values;
      time_step_ = last;
    }

    /** The next forces are those at the end of a step of this length; those
        after them at the same place. */
    void begin_step(double time_step);
    /** They are set. */
    void end_step() { moves_ = false; }
    /** As it was before the step; forces at its start are to be set. */
    void go_back();

  protected:
    std::vector<double> now_, before_;
    double time_step_ = 0., time_step_before_ = 0.; ///< s
    bool moves_ = false;
  };

  /**
   * What the points of cells keep whose materials have a history, at the
   * places of the last forces and a step before. The stress of a place is that
   * of its strain and of what is kept there, so that forces at the same place
   * are the same. Strains are those of sdim dimensions: rings are strained in
   * space.
   */
  template <int dim, int sdim = dim>
  class CellHistories final : public KeptHistories
  {
  public:
    explicit CellHistories(const Discretization<dim> &discretization);
    ~CellHistories() override;

    bool any() const { return first_.back() > 0; }
    /** Null: its material has none. */
    const HistoryMaterial<sdim> *of(const std::size_t cell) const;

    std::vector<double> at_rest() const override;

    struct Stress {
      Voigt<sdim> S;
      double energy = 0.;                ///< J per volume
      double plastic = 0., viscous = 0.; ///< of the step, never negative
    };
    /** Of point @p q at @p C. @p n_same points behind it keep the same. False
        where there is no stress. */
    bool set_point(std::size_t cell, unsigned int q, unsigned int n_same,
                   const Voigt<sdim> &C, Stress &result);
    /** At a place with what point @p q keeps, which does not change. */
    bool beside(std::size_t cell, unsigned int q, const Voigt<sdim> &C,
                Voigt<sdim> &S) const;

    // what a cell keeps and where it was strained to, for other ranks

    std::size_t n_numbers(const std::size_t cell) const
    {
      return of(cell) ? first_[cell + 1] - first_[cell] +
                            n_points(cell) * Voigt<sdim>().size()
                      : 0;
    }
    void pack(std::size_t cell, double *values) const;
    void unpack(std::size_t cell, const double *values);

  private:
    std::size_t n_points(const std::size_t cell) const
    {
      return (first_[cell + 1] - first_[cell]) / of(cell)->n_history();
    }
    std::size_t place(std::size_t cell, unsigned int q) const;

    const Discretization<dim> &discretization_;
    std::vector<std::unique_ptr<const HistoryMaterial<sdim>>> materials_;
    std::vector<std::size_t> first_, first_point_; ///< by cell
    std::vector<Voigt<sdim>> strains_; ///< C of the last forces, by point
  };
} // namespace nsfd
