#pragma once

#include "load_clock.h"

#include "nsfd/records/run_record.h"
#include "nsfd/state/point_kind.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace nsfd
{
  /** What pressed on a place of a surface in a step of a large motion. */
  struct SurfaceTouch {
    bool obstacle = false;       ///< or another body
    unsigned int block = 0;      ///< of the obstacles, or of the contacts
    unsigned int material_2 = 0; ///< of the body that has the place
    double weight = 0.;          ///< of the place, m or m^2
    double opening = 0.;         ///< at the end of the step, m
    /// at the middle of the step; the normal to body 2, the impulse on it, N s
    std::array<double, 3> position{}, normal{}, impulse{};
  };

  /** What is dissipated warms the bodies; empty where a scene has no heat. */
  struct HeatState {
    std::vector<double> temperature; ///< K, by corner of the cells
    double made = 0.;   ///< by friction, damage and flow since t = 0, J
    double given = 0.;  ///< by sides since t = 0, J
    double stored = 0.; ///< in the bodies since t = 0, J
    double moved = 0.;  ///< sum of its parts, whatever their sign: the most, J
    double hottest = 0., hottest_of_run = 0.; ///< K
    double conducted_until = 0.;              ///< s
    /// by point, K: of the face, and that at which its law began to soften,
    /// until then the same; empty if no law and no friction depends on it
    std::vector<double> at_faces, of_laws;
    /// of the last step, J: by point, and by cell the plastic work; a
    /// checkpoint has none
    std::vector<double> of_points, of_cells;
  };

  /**
   * Everything that changes in time, as plain values: copied and swapped.
   * Bodies: q, v by unknown. Points: dim components in the local frame.
   */
  struct State {
    unsigned int step = 0;
    double time = 0.;
    double last_step = 0.; ///< that led here, s; 0 at the start
    double kept_step = 0.; ///< of explicit forces, see ElasticForces, s
    LoadClock clock;       ///< of the formulas of Boundary blocks
    /// at which a point broke last; 0: none has
    unsigned int growth_step = 0;
    std::vector<double> displacement, velocity;
    std::vector<double> jump;              ///< u, m
    std::vector<double> relative_velocity; ///< U, m/s
    std::vector<double> impulse;           ///< P of the last step, warm start
    std::vector<double> opening_max;       ///< d_m, m
    std::vector<double> slip_max; ///< largest |u_T| of laws with two damage
                                  ///< scalars, m; empty if there are none
    std::vector<double> beta;
    std::vector<double> slip; ///< accumulated |u_T| in contact
    /// by sliding, m and m/s: contact is at u_N = dilated - worn; empty if the
    /// scene has neither dilatancy nor wear
    std::vector<double> dilated, worn, dilation_speed, wear_speed;
    /// u_N >= -(sum): overlap of springs as they turned into contacts, and the
    /// largest way of a step at the speed at which the point has closed, m
    std::vector<double> released_overlap, approach;
    std::vector<PointKind> kind;
    std::vector<std::uint8_t> two_sided; ///< intact spring, also in compression
    std::vector<std::uint8_t> contact;   ///< contact impulse in the last step
    std::vector<double> bond_traction; ///< {sigma n} at bonded points, Pa, dim
                                       ///< per point; empty without such
    std::vector<double> pressure; ///< in cracks in the last step, Pa; empty if
                                  ///< the scene has none
    std::optional<double> viscous_traction; ///< largest so far, Pa; if any
    EnergyLines energy;                     ///< dissipated lines and work: sums
    double initial_energy = 0., largest_energy = 0.;
    double penetration = 0., penetration_excess = 0., rigid_drift = 0.,
           positive_friction_work = 0., broken_area = 0.,
           pressure_work = 0.;       ///< of cracks, a part of the work
    std::vector<double> point_force; ///< of an equilibrium, N; empty if the
                                     ///< state is none
    // Of large motions, empty without: per rigid body centre, velocity,
    // quaternion (body to space), spin in the frame of the body (13 numbers)
    std::vector<double> rigid;
    std::vector<double> obstacle_shift; ///< of moving ones, 3 per obstacle, m
    /// of implicit motions with contacts of bodies: how far nodes went in the
    /// last step, by unknown, m
    std::vector<double> last_way;
    /// per place of a surface, see bodies/surface_contacts.h: dim components,
    /// and its history
    std::vector<double> surface_impulse, surface_slip, surface_worn,
        surface_wear_speed, surface_overlap, surface_approach;
    std::vector<std::uint8_t> surface_contact;
    /// key of the side that a point was over at the start of the last step,
    /// or Surfaces::no_key, and how far, m
    std::vector<std::uint64_t> surface_facet;
    std::vector<double> surface_gap;
    /// of the bodies of this rank, in the last step only: a checkpoint has none
    std::vector<SurfaceTouch> touches;
    /// what history-dependent materials keep, cell by cell and point by point
    /// of the cell quadrature, see bodies/history_cell.h; empty without such
    std::vector<double> material_history;
    HeatState heat;
  };
} // namespace nsfd
