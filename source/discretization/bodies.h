#pragma once

#include "linear_algebra/block_kernels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace nsfd
{
  /** A dense block, column-major, leading dimension padded(rows). */
  struct Block {
    unsigned int rows = 0, cols = 0;
    std::vector<double> values;

    Block() = default;
    Block(unsigned int rows, unsigned int cols);
    double &operator()(unsigned int r, unsigned int c)
    {
      return values[std::size_t(c) * padded(rows) + r];
    }
    double operator()(unsigned int r, unsigned int c) const
    {
      return values[std::size_t(c) * padded(rows) + r];
    }
    Block transposed() const;
  };

  /** C = A B. */
  Block product(const Block &A, const Block &B);

  /** Lower Cholesky factor of a symmetric positive definite block. */
  Block cholesky(const Block &A);

  /** L^{-1} B by forward substitution. */
  Block forward_solve(const Block &L, Block B);

  /** A^T A, symmetric to the last bit. */
  Block gram(const Block &A);

  /**
   * Bodies of the same shape, material and face layout share their blocks.
   * Unknowns are nodal velocities of a deformable cell or the rigid modes of a
   * rigid one. A slot is a place on the surface where a face point may sit;
   * `trace` gives the velocity there: (slot, component) x unknown.
   */
  struct BodyClass {
    unsigned int n_dofs = 0, n_slots = 0;
    bool rigid = false;
    bool undeformed = false; ///< of a rigid material, whatever its unknowns
    unsigned int material = 0;
    Block mass, stiffness, trace; ///< stiffness is empty for rigid bodies
    /// of viscous materials and, but for explicit steps at nodes, of absorbing
    /// sides; else empty
    Block damping;
    Block absorbing; ///< of damping, the part of the sides; else empty
    /// of deformable bodies: the rigid motions R as columns, R^T mass R = 1
    Block rigid_motions;
    /// of deformable bodies in scenes with bonded faces: the traction on the
    /// outward normal at the slots, (slot, component) x unknown, in Pa/m
    Block traction;
    /// the largest ratio of sum over slots w |traction|^2 to u.K u, in Pa/m
    double traction_bound = 0.;
    Block viscous_traction;           ///< the same of velocities, Pa s/m
    std::vector<unsigned int> bodies; ///< members on this rank
  };

  /** Of stiffness and damping in M_hat = M + f K + g C of a step. */
  struct StepShares {
    StepShares(const double f, const double g = 0.) : stiffness(f), damping(g)
    {
    }
    double stiffness, damping; ///< f in s^2, g in s
  };

  /** What M_hat of a step of length h has beside M + h^2 theta^2 K. */
  struct StepTerms {
    /// of the velocity whose power is dissipated: + h viscous_theta C; 0:
    /// nothing is viscous
    double viscous_theta = 0.;
    /// Forces act in the middle of steps that keep
    /// v.(M - kept_step^2 K / 4) v / 2 + q.K q / 2, whatever their own length
    /// is: -(kept_step^2 - h^2) K / 4, and M_hat is positive while kept_step is
    /// stable; 0: forces are not explicit
    double kept_step = 0.;

    StepShares shares(const double h, const double theta) const
    {
      const double lost =
          kept_step > 0. ? (kept_step - h) * (kept_step + h) / 4. : 0.;
      return {h * h * theta * theta - lost, h * viscous_theta};
    }
  };

  /** Entry of M_hat of a body. */
  inline double step_entry(const BodyClass &body, const StepShares &shares,
                           const unsigned int i, const unsigned int j)
  {
    const double elastic =
        body.mass(i, j) +
        (body.rigid ? 0. : shares.stiffness * body.stiffness(i, j));
    return body.damping.rows == 0
               ? elastic
               : elastic + shares.damping * body.damping(i, j);
  }

  /** The bodies of this rank as flat lists. */
  struct Bodies {
    std::vector<BodyClass> classes;
    std::vector<unsigned int> class_of;
    std::vector<std::size_t> first_dof;  ///< per body, size n + 1
    std::vector<std::size_t> first_slot; ///< per body, size n + 1
    /// point at a slot, or n_points where there is none
    std::vector<unsigned int> slot_point;
    /// +1 where the body is body 2 of the point, -1 where it is body 1
    std::vector<signed char> slot_sign;
    /// further points at a slot that already has one (rare): slot and point,
    /// always body 2
    std::vector<std::pair<std::size_t, unsigned int>> extra_points;

    std::size_t size() const { return class_of.size(); }
    std::size_t n_dofs() const { return first_dof.back(); }
  };

  /** Face points as flat arrays; the first n_owned are counted once. */
  template <int dim>
  struct InterfacePoints {
    std::size_t n_points = 0, n_owned = 0;
    std::vector<double> position; ///< dim per point
    /// dim x dim each, of points, or of faces: see axes()
    std::vector<double> frames;
    /// to the last bit, all points of a face have one frame
    bool frame_of_face = false;
    std::vector<double> weight; ///< JxW in m (2D) or m^2
    /// of axisymmetric scenes, whose weights are in m^2: JxW in the half-plane,
    /// m; else empty
    std::vector<double> lengths;
    /// points of one face are consecutive
    struct Face {
      unsigned int first = 0, count = 0;
      std::uint64_t key = 0; ///< hash of (CellId, face), equal on all ranks
      int neighbor_rank = -1;
      bool boundary = false;
      std::array<unsigned long long, 2> cells{}; ///< global cell numbers
      std::array<int, 2> bodies{{-1, -1}};       ///< local, -1: none or remote
      std::array<double, dim> centre{};
      std::array<unsigned int, 2> materials{}; ///< of the sides with a cell
    };
    std::vector<Face> faces;           ///< owned and shared ones
    std::vector<unsigned int> face_of; ///< per point

    /// points shared with another rank, in an order both ranks know; `side` is
    /// the side (0: body 1, 1: body 2) that this rank computes
    struct Neighbor {
      int rank = 0;
      std::vector<unsigned int> points;
      std::vector<unsigned char> side;
    };
    std::vector<Neighbor> neighbors;

    /** Of a point, dim x dim: rows n, t1, t2. */
    const double *axes(const std::size_t point) const
    {
      return frames.data() +
             (frame_of_face ? face_of[point] : point) * dim * dim;
    }
    /** Its share of the face as it is drawn: of an axisymmetric scene in the
        half-plane, in m. */
    double measure(const std::size_t point) const
    {
      return lengths.empty() ? weight[point] : lengths[point];
    }
    /** dim x dim per point. */
    std::vector<double> frames_of_points() const;
  };

  /** By face, what a run never changes. */
  struct FixedFaces {
    std::vector<char> joined;   ///< cells are, and no law ever parts them
    std::vector<char> supports; ///< a motion is prescribed
  };

  /** The bodies of this rank, class by class, in the order of their work. */
  struct BodyOrder {
    struct Members {
      std::vector<unsigned int> bodies;
      std::size_t n_shared = 0; ///< the first ones: at points of other ranks
    };
    std::vector<Members> classes;
  };

  /** Per body: 1 where it has a point that is shared with another rank. */
  template <int dim>
  std::vector<char> shared_bodies(const Bodies &bodies,
                                  const InterfacePoints<dim> &points);

  template <int dim>
  BodyOrder shared_first(const Bodies &bodies,
                         const InterfacePoints<dim> &points);
} // namespace nsfd
