#pragma once

#include "moving_bodies.h"
#include "surface_cells.h"

#include "contact_detection/surface_search.h"

#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace nsfd
{
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
                    const MovingBodies<dim> &bodies,
                    const Communicator &communicator);

    /** Nothing kept; broken faces are surfaces from the start.
        Collective. */
    void set_initial(State &state) const;

    /** What State::surface_contact says of a place, added up. */
    enum Mark : std::uint8_t {
      touches = 1,
      released = 2 ///< something let go of its body in the last step
    };

    /**
     * Points between two bodies that nothing holds together any more are left
     * to the search: `separated`. Collective.
     */
    void part(State &state) const;
    /** After the step of the last call of rows(). */
    void store_facets(State &next) const;

    /** What may touch in a step of @p time_step from @p old, on all ranks the
        same. Collective. */
    std::vector<MovingRow<dim>> rows(const State &old, double time_step);

    struct Counters {
      unsigned long long searches = 0, facets = 0, rows = 0;
      unsigned long long edge_rows = 0; ///< of these rows
      double largest_overlap = 0.;      ///< of all pairs at starts of steps, m
    };
    const Counters &counters() const { return counters_; }

  private:
    using Row = MovingRow<dim>;
    using Vector = dealii::Tensor<1, dim>;
    using Pair = std::uint64_t;
    /// more than there are; keys of facets begin with the place of their face
    static constexpr std::uint64_t pieces_per_face = 64;

    static Pair pair_of(const unsigned int a, const unsigned int b)
    {
      return a < b ? (Pair(a) << 32 | b) : (Pair(b) << 32 | a);
    }
    std::size_t place_of(unsigned int cell, unsigned int face,
                         unsigned int node) const;
    std::size_t place_of_edge(unsigned int node_1, unsigned int node_2) const;
    int block_of(unsigned int body_1, unsigned int body_2) const;
    bool may_touch(unsigned int body) const;
    void number_edges();
    bool is_surface(unsigned int cell, unsigned int face) const;
    bool follow(const State &state);
    bool share_separated(const State &state);
    void set_surfaces();
    void set_sides();
    void set_moving_nodes();
    void share_motion(const State &old);
    bool is_corner(unsigned int cell, unsigned int face,
                   unsigned int node) const;
    void add_face(unsigned int cell, unsigned int face);
    void add_obstacle_faces();
    void add_surface_rows(const State &old, double reach,
                          std::vector<Row> &rows);
    std::vector<Row> own_obstacle_rows(const State &old, double reach) const;
    Row ball_row(unsigned int body) const;
    void set_partner(const FacetPair<dim> &pair, const State &old,
                     Row &row) const;
    static constexpr std::size_t unseen = Row::nowhere;
    /** Which row sees it from the other side, or @p unseen; else it has that
        @p index. */
    std::size_t seen_from_there(const FacetPair<dim> &pair, const Row &row,
                                std::size_t index);
    Row edge_row(const EdgePair<dim> &pair, const State &old) const;
    int body_of_key(std::uint64_t key) const;
    std::array<std::size_t, 2> places_of_face(unsigned int facet) const;
    void take_over(const FacetPair<dim> &pair, const State &old,
                   Row &row) const;
    std::uint8_t mark_of(const State &old, unsigned int facet) const;
    Vector velocity(std::size_t node) const;
    Vector centre_velocity(const State &old, unsigned int body) const;

    const SceneInput &input_;
    const Discretization<dim> &discretization_;
    const BodyTable &table_;
    const MovingBodies<dim> &bodies_;
    const Communicator &all_;
    const SurfaceCells<dim> cells_;
    std::vector<std::size_t> first_place_; ///< per cell, then of balls
    std::vector<Pair> edges_; ///< in space: pairs of merged nodes, sorted
    std::vector<int> block_by_materials_;

    // of the surfaces at hand
    struct Side {
      unsigned int cell, face;
      Vector normal;
    };
    std::unordered_map<unsigned int, std::vector<Side>> sides_at_;
    std::vector<char> separated_; ///< per mesh face
    bool known_ = false;
    std::vector<std::size_t> moving_nodes_, own_moving_nodes_; ///< of surfaces
    std::vector<double> x_, v_; ///< of them by node, and centres
    std::unordered_set<Pair> joined_;
    Surfaces<dim> surfaces_;
    struct Origin {
      unsigned int cell, face, node; ///< node of the face
    };
    std::vector<Origin> point_origins_;
    std::vector<std::size_t> point_places_;
    std::vector<std::pair<unsigned int, unsigned int>> points_by_vertex_;
    std::vector<unsigned int> facet_cells_;
    std::vector<ObstacleFace> obstacle_faces_;
    SurfaceSearch<dim> search_;
    NearPairs<dim> pairs_;
    /// normals of contacts between two corners, by own node and other one
    struct Seen {
      Vector normal;
      std::size_t row;
    };
    std::unordered_map<Pair, Seen> seen_;
    Counters counters_;
  };
} // namespace nsfd
