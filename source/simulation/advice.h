#pragma once

#include "delassus/delassus_operator.h"
#include "discretization/discretization.h"
#include "nonsmooth/one_step_problem.h"

#include <array>
#include <vector>

namespace nsfd
{
  struct SceneInput;
  struct InterfaceInput;
  struct State;

  /** zeta of (51): mean traction over the largest; 0 for laws with a tail. */
  double mean_traction_ratio(const CohesiveLaw &law);

  /** (50), with the mean traction of (51); zeta = 1/2 for laws with a tail. */
  double cohesive_length(double young, double poisson, const CohesiveLaw &law);

  /** Where the isotropic average over normals stands: <n_1^4> and
   * <n_1^2> - <n_1^4>. */
  struct NormalAverage {
    double normal = 0., shear = 0.;
  };
  NormalAverage isotropic_average(unsigned int dimension);

  /**
   * Smallest C_N for which faces of area @p Z per volume leave the share @p eta
   * of the modulus: E Z f eta / (1 - eta), f = <n_1^4> + (<n_1^2> - <n_1^4>)
   * C_N / C_T. @p young is E / (1 - nu^2) in plane strain.
   */
  double smallest_stiffness(double young, double Z, unsigned int dimension,
                            double stiffness_ratio, double eta);

  /** C_N L/E over points per cohesive length: both ends of (54). */
  struct StiffnessBounds {
    double lower = 0., upper = 0.;
    bool conflict() const { return lower > upper; }
  };

  /**
   * Of C_N L/E: from below by @p smallest_stiffness, from above by @p points
   * points on a face of length @p L, of which @p resolved must lie on the
   * cohesive length. The law keeps its toughness and its shape, so that
   * R_max^2 / (C_N G) is a number: 2 for the brittle law of (54).
   */
  StiffnessBounds stiffness_bounds(double smallest_stiffness, double young,
                                   double poisson, const CohesiveLaw &law,
                                   double L, unsigned int points,
                                   double resolved);

  /** The faces of an Interface block: sums of area over the volume of the mesh.
   */
  struct FaceFamily {
    double density = 0.;                     ///< Z, 1/m
    std::array<double, 3> normal{}, shear{}; ///< of n_a^4, n_a^2 - n_a^4
    std::vector<unsigned int> materials;     ///< elastic ones that it touches
    double longest = 0.; ///< of its faces, m; in space the root of the area

    /** Added to 1/E by uniform stress along an axis. */
    double compliance(unsigned int axis, double C_N, double C_T) const;
  };

  /** One per Interface block, by the points of the mesh. Collective. */
  template <int dim>
  std::vector<FaceFamily>
  face_families(const SceneInput &input,
                const Discretization<dim> &discretization, double volume,
                const Communicator &communicator);

  /** C_N and C_T of the intact faces of a block; infinite where rigid. */
  std::array<double, 2> intact_stiffness(const InterfaceInput &block);

  /** @p state, but every point of @p block (all if -1) with a cohesive law is
   * active and as far open as its law softens. */
  template <int dim>
  State all_softening(const State &state, const Discretization<dim> &,
                      const SceneInput &input, int block = -1);

  /**
   * (38) for a step: the largest eigenvalue of the flexibility of the
   * interfaces times the slope of the laws,
   *
   *     lambda_max( h^2 theta chi (w s f^2)^{1/2} W (w s f^2)^{1/2} ),
   *
   * over all cohesive points at once, by power iteration, from below to about
   * 1 %. Below 1 the step is a contraction. Laws whose slope is infinite are
   * left out. Changes the step of @p delassus. Collective.
   */
  template <int dim>
  double contraction_number(const SceneInput &input,
                            const OneStepProblem<dim> &problem,
                            const State &softening,
                            DelassusOperator<dim> &delassus, double time_step);
} // namespace nsfd
