#pragma once

#include "active_surfaces.h"
#include "moving_row.h"

#include "contact_detection/missed_contacts.h"

#include <unordered_map>
#include <vector>

namespace nsfd
{
  template <int dim>
  class TurningBodies;

  /**
   * The surfaces of the moving bodies: sides of the mesh, crack faces of faces
   * that have broken between two bodies, balls. It says which of their places
   * touch another surface or an obstacle in a step.
   *
   * A place of a surface is a node on a face of a cell, a ball or, in space, an
   * edge; what it keeps (slip, wear, the last impulse) stays with it
   * whatever it touches, in the arrays `surface_...` of the state. Contacts of
   * two edges belong to that of body 2; those of one edge share what it
   * keeps.
   *
   * All ranks know all surfaces, where they are and what they keep, and get
   * the same rows; each rank looks for what its own bodies touch. Bodies, cells
   * and nodes are those of SurfaceCells.
   */
  template <int dim>
  class SurfaceContacts
  {
  public:
    /** Collective. */
    SurfaceContacts(const SceneInput &input,
                    const Discretization<dim> &discretization,
                    const BodyLayout<dim> &bodies,
                    const Communicator &communicator);

    /** Nothing kept; broken faces are surfaces from the start.
        Collective. */
    void set_initial(State &state) const;

    /** What State::surface_contact says of a place, added up. */
    enum Mark : std::uint8_t {
      touches = 1,
      released = 2 ///< something has left its body, or its corner has split
    };

    /**
     * Points between two bodies that nothing holds together any more are left
     * to the search: `separated`. Collective. Those marked as @p alone are,
     * whatever else holds there; empty: none.
     */
    void part(State &state, const std::vector<char> &alone = {}) const;
    /** After the step of the last call of rows(). */
    void store_facets(State &next) const;

    /** See SurfaceCells::merged(). */
    unsigned int first_of_rigid(const std::size_t node) const
    {
      return cells_.merged(node);
    }
    /** Cells hang together now by common nodes, see ActiveSurfaces. The parts
        of a corner that has come apart are `released`: what touches one of them
        has been inside of the other one. */
    void set_wholes(typename ActiveSurfaces<dim>::Wholes wholes, State &state);
    /** What may touch in a step of @p time_step from @p old, on all ranks the
        same; nothing is faster than @p largest_speed. Collective. */
    std::vector<MovingRow<dim>> rows(const State &old, double time_step,
                                     double largest_speed);

    /**
     * What the step of the last call of rows() to @p next passes over, see
     * MissedContact; that of the shortest step. Collective.
     */
    std::optional<MissedContact<dim>> missed(const State &old,
                                             const State &next) const;

    struct Counters {
      unsigned long long searches = 0, facets = 0, rows = 0;
      unsigned long long edge_rows = 0; ///< of these rows
      double largest_overlap = 0.;      ///< of all pairs at starts of steps, m
    };
    const Counters &counters() const { return counters_; }

  private:
    using Row = MovingRow<dim>;
    using Vector = dealii::Tensor<1, dim>;

    void add_surface_rows(const State &old, double reach,
                          std::vector<Row> &rows);
    std::vector<Row> own_obstacle_rows(const State &old, double reach) const;
    Row ball_row(unsigned int body) const;
    double unseen_depth(const FacetPair<dim> &pair) const;
    void set_partner(const FacetPair<dim> &pair, const State &old,
                     Row &row) const;
    static constexpr std::size_t unseen = Row::nowhere;
    /** Which row sees it from the other side, or @p unseen; else it has that
        @p index. */
    std::size_t seen_from_there(const FacetPair<dim> &pair, const Row &row,
                                std::size_t index);
    std::size_t place_of_edge(const typename Surfaces<dim>::Edge &edge) const;
    Row edge_row(const EdgePair<dim> &pair, const State &old) const;
    int cell_of_key(std::uint64_t key) const;
    std::array<std::size_t, 2> places_of_face(unsigned int facet) const;
    void take(const State &old, std::size_t place, unsigned int over,
              Row &row) const;
    void take_at_vertex(const State &old, unsigned int vertex,
                        unsigned int over, Row &row) const;
    void take_over(const FacetPair<dim> &pair, const State &old,
                   Row &row) const;
    std::uint8_t mark_of(const State &old, unsigned int facet) const;
    Vector centre_velocity(const State &old, unsigned int body) const;
    void look_at_obstacles(const State &old, const State &next,
                           const TurningBodies<dim> &turning,
                           std::optional<MissedContact<dim>> &first) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const BodyTable &table_;
    const BodyLayout<dim> &bodies_;
    const Communicator &all_;
    const SurfaceCells<dim> cells_;
    const ContactPlaces<dim> places_;
    const ContactBlocks blocks_;
    ActiveSurfaces<dim> active_;
    std::vector<double> thickness_; ///< by body, at rest, m
    SurfaceSearch<dim> search_;
    NearPairs<dim> pairs_;
    /// normals of contacts between two corners, by own node and other one
    struct Seen {
      Vector normal;
      std::size_t row;
    };
    std::unordered_map<UnorderedPair, Seen> seen_;
    Counters counters_;
  };
} // namespace nsfd
