#pragma once

#include "conforming_space.h"

#include "discretization/bodies.h"
#include "linear_algebra/spd_solver.h"

#include <array>
#include <vector>

namespace nsfd
{
  /**
   * The sparse matrix A = M + s K + H^T diag(k) H of all bodies: pattern and
   * values. Only unknowns that move the points of a face are coupled across
   * it.
   */
  template <int dim>
  class SparseAssembly
  {
  public:
    /** @p coordinates as in make_assembled_delassus(). */
    SparseAssembly(const Communicator &communicator, const Bodies &bodies,
                   const InterfacePoints<dim> &points,
                   const std::vector<double> &coordinates);

    /**
     * Values for M_hat of @p s and springs @p k, one per local component,
     * without those of faces that are marked in @p left_out.
     */
    void assemble(const StepShares &s, const std::vector<double> &k,
                  const std::vector<char> &left_out = {});
    /** Add the springs of marked faces. */
    void add_springs(const std::vector<double> &k,
                     const std::vector<char> &faces);
    const SparseRows &matrix() const { return matrix_; }

    /**
     * Add @p values to consecutive columns of a row of this rank, from the
     * global number @p column on; all of them must be in the pattern.
     */
    void add(int row, long long column, const double *values, unsigned int n);

    /**
     * Faces between two bodies whose springs @p k are stiff against the
     * softer one of them: at every node of the face, whatever the direction,
     * they contribute more to the diagonal of A than that body. Alike on both
     * ranks of a shared face. In terms of a stiffness C that is about
     * C L/E > 2.
     */
    std::vector<char> carrying(const StepShares &s,
                               const std::vector<double> &k) const;

    /**
     * Per side and point, how stiff a spring there must be to contribute as
     * much to the diagonal of A as the body; infinite at rigid bodies and at
     * those of other ranks. Size n_points + 1.
     */
    std::array<std::vector<double>, 2> own_stiffness(const StepShares &s) const;

    /** Nodes at the same place on both sides of a face. */
    NodePairs node_pairs() const;
    /** Of faces with a rigid cell and between cells of two sizes, whose points
        tell the trace of the other or smaller one. */
    NodeTies node_ties() const;
    Unknowns unknowns() const;
    /** Nothing but node_pairs(), node_ties() and unknowns() looks at them. */
    void forget_coordinates() { coordinates_ = std::vector<double>(); }

  private:
    /** One side of a point: a slot of a body, here or on another rank. */
    struct Place {
      int body = -1;   ///< of this rank
      int remote = -1; ///< index in remote_
      unsigned int slot = 0;
      bool exists() const { return body >= 0 || remote >= 0; }
    };
    /** What another rank tells about its side of a point. */
    struct Remote {
      long long first = 0;
      bool rigid = false;
      std::vector<double> trace, coordinates; ///< (component, unknown)
    };
    /** A side of a face: the unknowns that move its points. */
    struct Side {
      long long first = 0; ///< global number of the body's first unknown
      bool rigid = false;
      std::vector<unsigned short> support; ///< numbers within the body
    };

    void find_places();
    void exchange_remote();
    Side side(std::size_t face, unsigned int s) const;
    double trace(const Place &place, unsigned int c, unsigned int j) const;
    double coordinate(const Place &place, unsigned int j) const;
    double distance(const Place &x, unsigned int i, const Place &y,
                    unsigned int j) const;
    std::vector<NodeTies::Follower> ties(std::size_t face) const;
    std::vector<NodeTies::Follower>
    rigid_ties(std::size_t face, const std::array<Side, 2> &sides) const;
    void build_pattern();
    void add_springs(std::size_t face, const std::vector<double> &k);
    int local_column(long long global) const;

    const Communicator &communicator_;
    const Bodies &bodies_;
    const InterfacePoints<dim> &points_;
    std::vector<double> coordinates_;
    std::array<std::vector<Place>, 2> places_; ///< per point
    std::vector<Remote> remote_;
    SparseRows matrix_;
    std::vector<double> work_;
  };
} // namespace nsfd
