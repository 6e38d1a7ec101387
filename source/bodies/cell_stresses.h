#pragma once

#include "discretization/discretization.h"
#include "nsfd/materials/history_material.h"
#include "state/state.h"

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace nsfd
{
  template <int dim>
  struct BodyShape;
  template <int dim>
  class Sampler;

  /** Cauchy stresses of a state, also of history-dependent materials. */
  template <int dim>
  class CellStresses
  {
  public:
    /** Both must stay as they are. */
    CellStresses(const Discretization<dim> &discretization, const State &state);
    ~CellStresses();

    using Stress = std::array<double, 6>; ///< xx, yy, zz, xy, xz, yz, Pa

    /** A material of the scene is history dependent. */
    bool any_memory() const { return !first_.empty(); }
    bool is_history_dependent(unsigned int body) const;

    /** At the points of Discretization::visit_quadrature(), in its order, from
        displacement and gradient there: without that of viscosity. */
    Stress visit(unsigned int body, const dealii::Point<dim> &x,
                 const double *value, const double *gradient);

    /** At every quadrature point of every cell of this rank, with that of
        viscosity, from nodal displacements and velocities of the mesh. */
    using Visitor = std::function<void(unsigned int body,
                                       const dealii::Point<dim> &position,
                                       double JxW, const Stress &stress)>;
    void visit_all(const std::vector<double> &displacement,
                   const std::vector<double> &velocity, const Visitor &visitor);

    struct Sample {
      Stress stress{};            ///< with that of viscosity
      double plastic_strain = 0.; ///< equivalent
    };
    /**
     * At place @p q of a sampler in a cell, from nodal displacements and
     * velocities of the mesh. Of a history-dependent body: what is nearest to
     * its quadrature points in the mean square.
     */
    Sample at(unsigned int body, const Sampler<dim> &sampler, unsigned int q,
              const std::vector<double> &displacement,
              const std::vector<double> &velocity);

  private:
    /** Of a history-dependent body, at its nodes: 6 stresses and the equivalent
        plastic strain. */
    std::vector<double> at_nodes(unsigned int body,
                                 const std::vector<double> &nodal) const;
    Sample from_nodes(const Sampler<dim> &sampler, unsigned int q) const;
    const double *history(unsigned int body, unsigned int q) const;
    /** What gradients of a history-dependent cell are strained by, from nodal
        displacements @p u: see FiniteForces; 0: they stay what they are. */
    double dilatation(const BodyShape<dim> &shape, const double *u) const;
    Stress stress(unsigned int body, unsigned int q, double dilatation,
                  const double *gradient, double hoop) const;
    unsigned int n_history(unsigned int material) const;
    double plastic_strain(unsigned int body, unsigned int q) const;

    const Discretization<dim> &discretization_;
    const State &state_;
    /// by material; of axisymmetric scenes the second ones, in space
    std::vector<std::unique_ptr<const HistoryMaterial<dim>>> materials_;
    std::vector<std::unique_ptr<const HistoryMaterial<3>>> of_rings_;
    std::vector<std::size_t> first_;    ///< by cell; empty: nothing keeps
    unsigned int body_ = 0, point_ = 0; ///< visited next
    double dilatation_ = 0.;            ///< there
    std::vector<double> nodes_;         ///< those of the body sampled last
    unsigned int sampled_ = 0;
  };
} // namespace nsfd
