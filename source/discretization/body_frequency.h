#pragma once

#include "body_shape.h"

#include <array>
#include <vector>

namespace nsfd
{
  template <int dim>
  struct Cells;

  /** Largest eigenvalue of a symmetric matrix and its last component. */
  std::array<double, 2> largest_eigenpair(const Block &A);

  /** The former alone, of a positive semidefinite matrix, also where
      eigenvalues coincide: no vectors. */
  double largest_eigenvalue(const Block &A);

  /** omega_max of a free body from its blocks, rad/s; 0 of a rigid one. */
  double highest_frequency(const BodyClass &body);

  /** The same of a simplex of constant strain with lumped mass. */
  template <int dim>
  double highest_frequency(const BodyShape<dim> &shape);

  /** Not less than that, without an eigenvalue problem of its size. */
  template <int dim>
  double frequency_bound(const BodyShape<dim> &shape);

  /**
   * By body: omega_max from blocks, or its bound for simplices without any.
   */
  template <int dim>
  std::vector<double> frequencies_of_bodies(const Cells<dim> &cells);

  /** omega_max over all bodies of this rank. */
  template <int dim>
  double highest_frequency(const Cells<dim> &cells);

  /** The longest explicit step of a body with omega, whose damping is the share
      @p b of the critical one of that mode: h^2 omega^2/4 + h b omega = 1. */
  double longest_step(double omega, double b);

  /**
   * By body: the longest explicit step if it is free, with lumped mass and
   * the share @p b of critical damping beside that of viscous materials, which
   * acts with the rate of the step before; infinite of rigid ones.
   */
  template <int dim>
  std::vector<double> longest_steps(const Cells<dim> &cells, double b);

  /**
   * The same where it is among the @p n shortest, or at most @p factor times
   * the shortest one; of others not more than that, and more than those.
   */
  template <int dim>
  std::vector<double> shortest_steps(const Cells<dim> &cells, double b,
                                     std::size_t n, double factor);
} // namespace nsfd
