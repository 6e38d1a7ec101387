#include "core/gather.h"

#include "nonsmooth/frictional_contact/contact_solver.h"
#include "nonsmooth/solver.h"

#include <algorithm>
#include <array>
#include <map>
#include <mpi.h>
#include <tuple>
#include <utility>

namespace nsfd
{
  namespace
  {
    /**
     * Steps in which nothing but contact and friction acts, as between rigid
     * bodies: the Coulomb problem itself, its matrix assembled body by body,
     * for a solver that needs this and knows nothing of bodies. Rows of walls
     * and heaps depend on each other; these solvers are made for it. It works
     * on the first rank, with the bodies of all. All other steps go to the
     * cascade of solvers that know laws.
     */
    template <int dim>
    class AssembledSteps : public NonsmoothSolver<dim>
    {
    public:
      SolverReport solve(const OneStepProblem<dim> &problem,
                         DelassusOperator<dim> &delassus,
                         const double energy_scale,
                         const SolverControl &control,
                         std::vector<double> &impulse,
                         LawEvaluation<dim> &evaluation) override
      {
        SolverReport report;
        const Communicator &all = delassus.communicator();
        if (all.any(!applies(problem, delassus)))
          return go_on(problem, delassus, energy_scale, control, impulse,
                       evaluation, report);
        evaluation.update(impulse);
        double goal = control.tolerance / 3.;
        for (unsigned int round = 0;
             evaluation.error > control.tolerance && round < 3; ++round) {
          if (round == 0)
            assemble(problem, delassus);
          solve_contacts(goal, all, impulse, report);
          evaluation.update(impulse);
          goal /= 30.; // the measures of the two differ
        }
        report.residual = evaluation.error;
        report.converged = report.residual <= control.tolerance;
        if (report.converged)
          return report;
        return go_on(problem, delassus, energy_scale, control, impulse,
                     evaluation, report);
      }

    protected:
      virtual const ContactSolver &assembled() const = 0;

    private:
      /** No springs, joints or motions, and no lift by sliding. */
      static bool applies(const OneStepProblem<dim> &problem,
                          const DelassusOperator<dim> &delassus)
      {
        if (!problem.dilatancy.empty() || !delassus.bodies_are_apart())
          return false;
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.kind[i] != PointKind::free)
            return false;
        return true;
      }

      SolverReport
      go_on(const OneStepProblem<dim> &problem, DelassusOperator<dim> &delassus,
            const double energy_scale, const SolverControl &control,
            std::vector<double> &impulse, LawEvaluation<dim> &evaluation,
            SolverReport report) const
      {
        const auto cascade = SolverRegistry<dim>::instance().create("cascade");
        const SolverReport next = cascade->solve(
            problem, delassus, energy_scale, control, impulse, evaluation);
        report.switches.push_back("chain"); // as summary.json counts it
        report.go_on_with(next);
        return report;
      }

      /** Of a face, and a number of its points: places among all ranks. */
      using Key = std::pair<std::uint64_t, unsigned int>;

      struct Contact {
        std::uint64_t face;
        unsigned int number;
        double friction;
        std::array<double, dim> q;
      };

      using Square = std::array<double, dim * dim>;

      /** What one body adds to the matrix. */
      struct Part {
        std::uint64_t face_i, face_j;
        unsigned int number_i, number_j;
        Square block;
      };

      static Key key_of(const InterfacePoints<dim> &points, const std::size_t i)
      {
        const auto &face = points.faces[points.face_of[i]];
        return {face.key, unsigned(i - face.first)};
      }

      /** U = W P + U_free of the points that may touch, in their frames. */
      void assemble(const OneStepProblem<dim> &problem,
                    const DelassusOperator<dim> &delassus)
      {
        const Communicator &all = delassus.communicator();
        points_.clear();
        for (std::size_t i = 0; i < problem.n_points; ++i)
          if (problem.contact[i])
            points_.push_back(i);
        gather_contacts(all, problem, delassus.points());
        const auto parts = gather(all, parts_of_bodies(problem, delassus));
        if (!all.is_root())
          return;
        std::vector<std::map<unsigned int, Square>> rows(
            contact_.friction.size());
        // a block has parts of at most two bodies: their order does not matter
        for (const Part &part : parts) {
          Square &sum = rows[number_.at({part.face_i, part.number_i})]
                            [number_.at({part.face_j, part.number_j})];
          for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += part.block[k];
        }
        set_matrix(rows);
      }

      /** Numbers, friction and U_free on the first rank; who has which point.
       */
      void gather_contacts(const Communicator &all,
                           const OneStepProblem<dim> &problem,
                           const InterfacePoints<dim> &points)
      {
        std::vector<Contact> mine;
        for (const std::size_t i : points_) {
          Contact contact;
          std::tie(contact.face, contact.number) = key_of(points, i);
          contact.friction = friction_of(problem, i);
          for (unsigned int c = 0; c < dim; ++c)
            contact.q[c] = problem.free_velocity[i * dim + c] +
                           (c == 0 ? -problem.target[i]
                                   : problem.sliding_offset[i * dim + c]);
          mine.push_back(contact);
        }
        const auto seen = gather(all, mine, n_seen_);
        auto contacts = seen;
        std::sort(contacts.begin(), contacts.end(),
                  [](const Contact &a, const Contact &b) {
                    return std::tie(a.face, a.number) <
                           std::tie(b.face, b.number);
                  });
        contact_ = ContactProblem();
        contact_.dimension = dim;
        number_.clear();
        for (const Contact &contact : contacts) {
          // what two ranks see is the same
          if (!number_
                   .emplace(Key(contact.face, contact.number),
                            unsigned(number_.size()))
                   .second)
            continue;
          contact_.friction.push_back(contact.friction);
          contact_.q.insert(contact_.q.end(), contact.q.begin(),
                            contact.q.end());
        }
        number_of_seen_.clear();
        for (const Contact &contact : seen)
          number_of_seen_.push_back(number_.at({contact.face, contact.number}));
      }

      std::vector<Part>
      parts_of_bodies(const OneStepProblem<dim> &problem,
                      const DelassusOperator<dim> &delassus) const
      {
        std::vector<Part> parts;
        const Bodies &bodies = delassus.bodies();
        const auto &points = delassus.points();
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const Block &W = delassus.class_blocks()[bodies.class_of[b]].delassus;
          const auto touches = [&](const std::size_t slot) {
            const std::size_t i = bodies.slot_point[slot];
            return i < problem.n_points && problem.contact[i];
          };
          for (std::size_t s = bodies.first_slot[b];
               s < bodies.first_slot[b + 1]; ++s)
            for (std::size_t t = bodies.first_slot[b];
                 t < bodies.first_slot[b + 1]; ++t) {
              if (!touches(s) || !touches(t))
                continue;
              const std::size_t i = bodies.slot_point[s],
                                j = bodies.slot_point[t];
              Part &part = parts.emplace_back();
              std::tie(part.face_i, part.number_i) = key_of(points, i);
              std::tie(part.face_j, part.number_j) = key_of(points, j);
              part.block =
                  block_of(W, unsigned(s - bodies.first_slot[b]),
                           unsigned(t - bodies.first_slot[b]),
                           double(bodies.slot_sign[s]) * bodies.slot_sign[t],
                           points.axes(i), points.axes(j));
            }
        }
        return parts;
      }

      static Square block_of(const Block &W, const unsigned int s,
                             const unsigned int t, const double sign,
                             const double *Q_i, const double *Q_j)
      {
        Square sum{};
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
            for (unsigned int c = 0; c < dim; ++c)
              for (unsigned int d = 0; d < dim; ++d)
                sum[a * dim + b] += sign * Q_i[a * dim + c] *
                                    W(s * dim + c, t * dim + d) *
                                    Q_j[b * dim + d];
        return sum;
      }

      /** Over the mean of its diagonal: its measure compares r with u. */
      void set_matrix(const std::vector<std::map<unsigned int, Square>> &rows)
      {
        unit_ = 0.;
        for (std::size_t i = 0; i < rows.size(); ++i)
          for (unsigned int c = 0; c < dim; ++c)
            unit_ += rows[i].at(unsigned(i))[c * dim + c] /
                     double(rows.size() * dim);
        contact_.row_start.assign(1, 0);
        for (const auto &row : rows)
          for (unsigned int c = 0; c < dim; ++c) {
            for (const auto &[j, block] : row)
              for (unsigned int d = 0; d < dim; ++d) {
                contact_.column.push_back(int(j * dim + d));
                contact_.value.push_back(block[c * dim + d] / unit_);
              }
            contact_.row_start.push_back(int(contact_.column.size()));
          }
      }

      void solve_contacts(const double tolerance, const Communicator &all,
                          std::vector<double> &impulse,
                          SolverReport &report) const
      {
        using Impulse = std::array<double, dim>;
        std::vector<Impulse> mine(points_.size());
        for (std::size_t k = 0; k < mine.size(); ++k)
          std::copy_n(&impulse[points_[k] * dim], dim, mine[k].begin());
        const auto seen = gather(all, mine);
        std::vector<Impulse> solved(seen.size());
        std::array<unsigned int, 3> counts{};
        if (all.is_root()) {
          // what two ranks see is the same
          std::vector<double> r(contact_.q.size());
          for (std::size_t k = 0; k < seen.size(); ++k)
            for (unsigned int c = 0; c < dim; ++c)
              r[number_of_seen_[k] * dim + c] = seen[k][c] * unit_;
          SolverControl control;
          control.tolerance = tolerance;
          const SolverReport part =
              solve_contact_problem(contact_, assembled(), "", control, r);
          counts = {{part.factorisations, part.iterations, part.products}};
          for (std::size_t k = 0; k < seen.size(); ++k)
            for (unsigned int c = 0; c < dim; ++c)
              solved[k][c] = r[number_of_seen_[k] * dim + c] / unit_;
        }
        MPI_Bcast(counts.data(), int(counts.size()), MPI_UNSIGNED, 0,
                  all.mpi());
        report.newton += counts[0];
        report.sweeps += counts[1];
        report.krylov += counts[2];
        mine = scatter(all, solved, n_seen_);
        std::fill(impulse.begin(), impulse.end(), 0.);
        for (std::size_t k = 0; k < mine.size(); ++k)
          std::copy_n(mine[k].begin(), dim, &impulse[points_[k] * dim]);
      }

      std::vector<std::size_t> points_; ///< of this rank that may touch
      // on the first rank
      ContactProblem contact_;
      std::map<Key, unsigned int> number_; ///< of the contacts of all ranks
      std::vector<unsigned int> number_of_seen_; ///< of the points_ of all
      std::vector<int> n_seen_;                  ///< by rank
      double unit_ = 1.;
    };

    template <int dim>
    class FrictionalContact final : public AssembledSteps<dim>
    {
    protected:
      const ContactSolver &assembled() const override { return solver_; }

    private:
      AssembledMethod<ContactMethod::automatic> solver_;
    };

    /** A method that needs W assembled, also for problems that bring it. */
    template <int dim, ContactMethod method>
    class Assembled final : public AssembledSteps<dim>,
                            public AssembledMethod<method>
    {
    public:
      const ContactSolver *contact_solver() const override { return this; }

    protected:
      const ContactSolver &assembled() const override { return *this; }
    };

    template <ContactMethod method>
    bool add(const char *name, const char *text)
    {
      return SolverRegistry<2>::instance().add<Assembled<2, method>>(name,
                                                                     text) &&
             SolverRegistry<3>::instance().add<Assembled<3, method>>(name,
                                                                     text);
    }

    // for steps, a run chooses among those that know laws by itself
    const bool assembled_methods[] = {
        add<ContactMethod::automatic>(
            "auto", "a cascade of the others, each as long as it promises to "
                    "pay"),
        add<ContactMethod::proximal>(
            "proximal", "proximal point around Newton, W assembled"),
        add<ContactMethod::admm>(
            "admm", "alternating directions with balanced penalty, W "
                    "assembled"),
        add<ContactMethod::projected_gradient>(
            "projected gradient", "accelerated, with restarts, W assembled")};

    using FrictionalContact2 = FrictionalContact<2>;
    using FrictionalContact3 = FrictionalContact<3>;
    NSFD_REGISTER(SolverRegistry<2>, FrictionalContact2, "frictional contact",
                  "contact and friction of rigid bodies by the solvers of "
                  "stored problems, else the cascade");
    NSFD_REGISTER(SolverRegistry<3>, FrictionalContact3, "frictional contact",
                  "contact and friction of rigid bodies by the solvers of "
                  "stored problems, else the cascade");
  } // namespace
} // namespace nsfd
