#pragma once

#include "bisection.h"

#include "joined/joined_mesh.h"
#include "nsfd/core/archive.h"
#include "state/state.h"

#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace nsfd
{
  /**
   * Carries what joined triangles have over a bisection of some of them.
   *
   * A new node is in the middle of an edge: its displacement and its velocity
   * are the means of those of the two ends in the same cell. Strains and their
   * rates stay, and with them all elastic energies; both sides of an open face
   * keep their own motion. Of the velocity (a + b)/2 lumped masses keep the
   * momentum, and lose m |a - b|^2 / 24 of the kinetic energy of each cell of
   * mass m that is halved.
   *
   * A half of a face inherits, at both of its points, from the point at the end
   * that is its own: kind, history, jump and factors of both chains. Weights
   * and densities stay, so that energy and damage do. Where both ends are free,
   * nothing is stored, and the jump is that of the nodes. Faces inside an old
   * cell are intact.
   */
  class BisectionTransfer
  {
  public:
    /**
     * From the @p cells as they were settled, body b of @p discretization is
     * old cell b, to what they are at set_mesh(), where body b is cell b.
     */
    BisectionTransfer(const Bisection &cells,
                      const Discretization<2> &discretization,
                      const JoinedMesh<2> &mesh);
    ~BisectionTransfer();

    /** What goes into it, in the order of the old mesh. */
    Archive &old_parts();
    /** The cells are others now, and so is the mesh of them. */
    void set_mesh(const Discretization<2> &discretization,
                  const JoinedMesh<2> &mesh);
    /** The state there; times and energies stay. After set_mesh(). Where cells
        are joined, corners of a node may have several velocities: their mean
        in the sense of the masses keeps the momentum. */
    State state(const State &old) const;
    /** Where cells are joined, on the new mesh: what the nodes have of the
        @p given state(). Rates of cells whose corners have other velocities are
        others. */
    void set_motion(const Discretization<2> &discretization, const State &given,
                    const State &taken);
    /** psi eta of the front viscosity of the old cells, Pa s; after old_parts()
        was filled. */
    std::vector<double> front_viscosities() const;
    /** What went into old_parts(), in the order of the new mesh. */
    Archive &new_parts();

  private:
    class Store;
    class Writer;
    class Reader;
    friend class Reader;

    /** Of the old points that a point is made of. */
    struct Origin {
      unsigned int own = Bisection::none; ///< none: the face is new
      std::array<unsigned int, 2> ends{}; ///< of the old face
      double share = 0.;                  ///< of the second one, along the face
      double weight = 1.;                 ///< over that of `own`
    };
    struct OldFace {
      PointOrigin::Kind kind;
      unsigned int block; ///< 0 for interfaces: it stays with the face
      std::array<unsigned int, 2> points; ///< at the smaller vertex first
    };

    void add_face(unsigned int first, const Discretization<2> &discretization,
                  const JoinedMesh<2> &mesh);
    void find_origins(unsigned int first,
                      const Discretization<2> &discretization,
                      const JoinedMesh<2> &mesh);
    double share_of(unsigned int vertex,
                    const std::array<unsigned int, 2> &edge) const;
    void add_value(const std::vector<double> &old, unsigned int cell,
                   unsigned int vertex, double share, double *value) const;
    enum class Field { displacement, velocity };
    std::vector<double> nodal(const std::vector<double> &old,
                              Field field) const;
    std::vector<double> front(const std::vector<double> &old) const;
    template <typename T>
    std::vector<T> pointwise(const std::vector<T> &old, T fresh) const;
    std::vector<double> jumps(const std::vector<double> &old,
                              const std::vector<std::uint8_t> &kinds,
                              unsigned int width) const;

    const Bisection &cells_;
    std::unordered_multimap<Bisection::Edge, OldFace> old_faces_;
    std::vector<double> old_weights_;
    std::vector<Origin> origins_; ///< of the new points
    /// where cells are joined: dilatations times area of the cells, and rates,
    /// 1/s; NaN: it stayed
    std::vector<double> dilatations_, rates_;
    mutable double stored_by_front_ = 0.; ///< see FrontViscosity::Powers
    std::unique_ptr<Store> store_;
  };
} // namespace nsfd
