#include "nsfd/simulation.h"

#include "nsfd/base/version.h"
#include "nsfd/input/command_line.h"
#include "nsfd/input/scene_input.h"
#include "nsfd/mesh/mesh_builder.h"
#include "nsfd/output/field_output.h"
#include "nsfd/output/history_file.h"
#include "nsfd/output/progress.h"
#include "nsfd/output/report.h"
#include "nsfd/output/summary_file.h"
#include "nsfd/scene/check.h"
#include "nsfd/scene/verification_case.h"
#include "nsfd/time/moreau_jean.h"
#include "nsfd/time/step_control.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>

namespace nsfd
{
  namespace
  {
    volatile std::sig_atomic_t stop_requested = 0;
    void request_stop(int) { stop_requested = 1; }

    double wall_seconds()
    {
      return std::chrono::duration<double>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
    }

    double cpu_seconds()
    {
      rusage usage;
      getrusage(RUSAGE_SELF, &usage);
      return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
             1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    }

    double peak_memory_mb()
    {
      rusage usage;
      getrusage(RUSAGE_SELF, &usage);
      return double(usage.ru_maxrss) / 1024.;
    }

    std::string today()
    {
      const std::time_t now = std::time(nullptr);
      char text[32];
      std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ",
                    std::gmtime(&now));
      return text;
    }

    /**
     * Make the output directory ours. False with a message if it holds files
     * and --force was not given.
     */
    bool claim_directory(const std::string &directory, const bool force)
    {
      namespace fs = std::filesystem;
      std::error_code error;
      if (fs::exists(directory, error) && !fs::is_empty(directory, error)) {
        if (!force) {
          std::cerr << "the output directory `" << directory
                    << "` exists already: nothing was run.\n"
                    << "  write --force to replace it, or --output DIR\n";
          return false;
        }
        // replace what a run has written, leave everything else
        for (const auto &entry : fs::directory_iterator(directory)) {
          const std::string extension = entry.path().extension().string();
          for (const char *ours :
               {".vtu", ".pvtu", ".pvd", ".csv", ".json", ".svg", ".html"})
            if (extension == ours)
              fs::remove(entry.path(), error);
        }
      }
      fs::create_directories(directory, error);
      if (error) {
        std::cerr << "cannot create the output directory `" << directory
                  << "`: " << error.message() << "\n";
        return false;
      }
      return true;
    }

    /** Reports every sentence; true if there was none. */
    bool print_problems(const std::vector<std::string> &problems,
                        const std::string &file,
                        const char *kind)
    {
      for (const auto &problem : problems)
        std::cerr << file << ": " << kind << ": " << problem << "\n";
      return problems.empty();
    }

    template <int dim>
    class Simulation
    {
    public:
      Simulation(const SceneInput &input,
                 const RunOptions &options,
                 const Communicator &communicator);
      int run();

    private:
      bool build();
      void open_output();
      void record(const StepReport &report, double time_step);
      void observe(const HistoryRow &row);
      void write_if_due(bool last);
      void norms();
      void finish(const std::string &failure);

      const SceneInput &input_;
      const RunOptions &options_;
      const Communicator &communicator_;

      std::unique_ptr<dealii::Triangulation<dim>> triangulation_;
      std::unique_ptr<MeshGroups<dim>> groups_;
      std::unique_ptr<Discretization<dim>> discretization_;
      std::unique_ptr<Dynamics<dim>> dynamics_;
      std::unique_ptr<NonsmoothSolver<dim>> solver_;
      std::unique_ptr<MoreauJean<dim>> stepper_;
      std::unique_ptr<StepControl> control_;
      std::unique_ptr<Fragments<dim>> fragments_;
      std::unique_ptr<FieldOutput<dim>> fields_;
      std::unique_ptr<HistoryFile> history_file_;
      std::unique_ptr<Progress> progress_;

      State state_;
      std::vector<HistoryRow> history_;
      unsigned int history_stride_ = 1;
      std::vector<Snapshot> snapshots_;
      std::vector<std::string> reaction_names_;
      Summary summary_;
      RunInfo info_;
      std::string path_, method_;
      double next_fields_ = 0., last_step_ = 0.;
      bool fields_current_ = false;
      double start_wall_ = 0., output_cpu_ = 0.;
      unsigned int rejected_ = 0, beyond_unique_ = 0;
      std::map<std::string, unsigned int> switches_;
    };

    template <int dim>
    Simulation<dim>::Simulation(const SceneInput &input,
                                const RunOptions &options,
                                const Communicator &communicator)
      : input_(input)
      , options_(options)
      , communicator_(communicator)
      , start_wall_(wall_seconds())
    {}

    template <int dim>
    bool Simulation<dim>::build()
    {
      const bool root = communicator_.is_root();
      std::vector<std::string> problems, warnings;
      triangulation_ =
        build_mesh<dim>(input_, communicator_.mpi(), problems);
      if (!triangulation_ || !problems.empty()) {
        if (root)
          print_problems(problems, input_.file, "error");
        return false;
      }
      groups_ = std::make_unique<MeshGroups<dim>>(input_, *triangulation_);
      const auto materials = material_indices<dim>(
        input_, *groups_, *triangulation_, problems, warnings);
      if (root)
        print_problems(warnings, input_.file, "warning");
      if (!problems.empty()) {
        if (root)
          print_problems(problems, input_.file, "error");
        return false;
      }
      try {
        discretization_ = std::make_unique<Discretization<dim>>(
          communicator_, *triangulation_, *groups_, materials, input_);
      } catch (const std::runtime_error &error) {
        if (root)
          print_problems({error.what()}, input_.file, "error");
        return false;
      }

      // blocks that hold nowhere are mistakes
      std::vector<double> used(input_.boundaries.size() +
                               input_.obstacles.size());
      const auto holds = [&](const Where &where) {
        bool any = false;
        for (const auto &cell : triangulation_->active_cell_iterators())
          if (cell->is_locally_owned())
            for (const unsigned int f : cell->face_indices())
              if (cell->face(f)->at_boundary())
                any = any || groups_->holds_boundary_face(where, cell, f);
        return communicator_.any(any);
      };
      for (const auto &boundary : input_.boundaries)
        if (!holds(boundary.where))
          problems.push_back("Boundary: " + boundary.name +
                             ": no boundary face of the mesh is there" +
                             groups_->missing(boundary.where));
      for (const auto &obstacle : input_.obstacles)
        if (!holds(obstacle.where))
          problems.push_back("Obstacle: " + obstacle.name +
                             ": no boundary face of the mesh is there" +
                             groups_->missing(obstacle.where));

      double base = input_.time.step;
      const double crossing = discretization_->crossing_time();
      if (input_.time.step_kind != StepKind::time) {
        if (crossing == 0.)
          problems.push_back("Time/step: all bodies are rigid, there is no "
                             "crossing time; write the step as a time");
        base *= crossing;
      }
      if (!problems.empty()) {
        if (root)
          print_problems(problems, input_.file, "error");
        return false;
      }
      control_ = std::make_unique<StepControl>(
        input_.time.end, base, input_.time.maximum_halvings);

      // short steps: face blocks; long ones: a global matrix
      path_ = input_.solver.path;
      if (path_ == "auto")
        path_ = crossing > 0. && control_->base_step() > 5. * crossing
                  ? "global"
                  : "element-wise";
      if (path_ == "global")
        dynamics_ = make_sparse_dynamics<dim>(
          communicator_, discretization_->bodies(), discretization_->points(),
          input_.solver.linear_solver == "cg" ? "cg" : "direct");
      else
        dynamics_ = make_elementwise_dynamics<dim>(communicator_,
                                                   discretization_->bodies(),
                                                   discretization_->points());
      method_ =
        input_.solver.method == "auto" ? "dual newton" : input_.solver.method;
      solver_ = SolverRegistry<dim>::instance().create(method_);
      stepper_ = std::make_unique<MoreauJean<dim>>(input_, *discretization_,
                                                   *dynamics_, *solver_);
      return true;
    }

    template <int dim>
    void Simulation<dim>::open_output()
    {
      const std::string &directory = input_.output.directory;
      for (const unsigned int b : discretization_->driven_boundaries())
        reaction_names_.push_back(input_.boundaries[b].name);

      info_.version = version().number;
      info_.git_hash = version().git_hash;
      info_.build_type = version().build_type;
      info_.command_line = options_.command_line;
      info_.file = input_.file;
      info_.date = today();
      char host[256] = "";
      gethostname(host, sizeof(host) - 1);
      info_.host = host;
      for (const auto &[name, version] : library_versions())
        info_.libraries[name] = version;
      info_.ranks = unsigned(communicator_.size());
      auto &parts = info_.parts;
      parts.emplace_back("mesh", input_.mesh.type);
      parts.emplace_back("element", discretization_->element().get_name());
      for (const auto &material : input_.materials)
        parts.emplace_back("material " + material.name,
                           material.rigid ? "rigid" : "linear elastic");
      for (const auto &block : input_.interfaces) {
        parts.emplace_back("interface " + block.name, block.law_name);
        if (block.strength_scatter > 0.)
          info_.seeds.push_back(block.seed);
      }
      for (const unsigned int b : discretization_->driven_boundaries())
        parts.emplace_back("motion", input_.boundaries[b].name);
      for (const auto &obstacle : input_.obstacles)
        parts.emplace_back("obstacle", obstacle.name);
      if (discretization_->has_loads())
        parts.emplace_back("loads", "body forces and tractions");
      parts.emplace_back("dynamics", path_);
      parts.emplace_back("solver", method_);
      if (input_.verification)
        parts.emplace_back("verification", "exact values");

      if (communicator_.is_root()) {
        write_file_atomically(directory + "/parameters.prm", input_.echo);
        write_run_info(directory + "/run.json", info_);
        history_file_ = std::make_unique<HistoryFile>(
          directory + "/history.csv", reaction_names_, dim);
        progress_ = std::make_unique<Progress>(
          std::cout, input_.time.end,
          Progress::mode_for_stdout(options_.quiet));
        if (!options_.quiet) {
          std::cout << fmt::format(
            "nsfd {}  {}  {} cells, {} unknowns, {} interface points, step "
            "{:.4g}",
            version().number, input_.file, discretization_->n_global_cells(),
            summary_.dofs, summary_.interface_points, control_->base_step());
          if (discretization_->crossing_time() > 0.)
            std::cout << fmt::format(
              " ({:.3g} crossings)",
              control_->base_step() / discretization_->crossing_time());
          std::cout << "\n";
          for (const auto &[kind, name] : parts)
            std::cout << fmt::format("  {:<24} {}\n", kind, name);
        }
      }
      if (input_.output.fields)
        fields_ = std::make_unique<FieldOutput<dim>>(
          directory, *discretization_, communicator_);
      else if (input_.output.report)
        fields_ = std::make_unique<FieldOutput<dim>>(
          directory, *discretization_, communicator_);
    }

    template <int dim>
    void Simulation<dim>::record(const StepReport &report,
                                 const double time_step)
    {
      HistoryRow row;
      row.step = state_.step;
      row.time = state_.time;
      row.time_step = time_step;
      row.energy = state_.energy;
      row.ledger_defect = report.ledger_defect;
      row.broken_area = state_.broken_area;
      row.fragments = fragments_->count();
      row.active = report.active;
      row.newton = report.solver.newton;
      row.krylov = report.solver.krylov;
      row.residual = report.solver.residual;
      row.reactions = stepper_->reactions();
      summary_.ledger_defect_max =
        std::max(summary_.ledger_defect_max, row.ledger_defect);
      summary_.residual_max = std::max(summary_.residual_max, row.residual);
      if (history_file_)
        history_file_->write(row);
      if (progress_)
        progress_->step(row);
      observe(row);
      // the report draws at most some ten thousand rows
      if (row.step % history_stride_ == 0)
        history_.push_back(row);
      if (history_.size() > 20000) {
        history_stride_ *= 2;
        std::vector<HistoryRow> thinned;
        for (auto &kept : history_)
          if (kept.step % history_stride_ == 0)
            thinned.push_back(std::move(kept));
        history_.swap(thinned);
      }
    }

    template <int dim>
    void Simulation<dim>::observe(const HistoryRow &row)
    {
      if (!input_.verification)
        return;
      StepView view;
      view.time = state_.time;
      view.time_step = row.time_step;
      view.row = &row;
      std::vector<CellState> cells;
      if (input_.verification->wants_cells()) {
        // centre, u, v, stress, volume
        constexpr unsigned int width = 16;
        const auto &bodies = discretization_->bodies();
        std::vector<double> mine(bodies.size() * width, 0.);
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          for (unsigned int c = 0; c < dim; ++c)
            mine[b * width + c] = discretization_->centre(unsigned(b))[c];
          mine[b * width + 15] = discretization_->volume(unsigned(b));
        }
        const auto average = [&](const std::vector<double> &unknowns,
                                 const unsigned int at, const bool stress) {
          discretization_->visit_quadrature(
            discretization_->to_nodal(unknowns),
            [&](const unsigned int b, const dealii::Point<dim> &,
                const double JxW, const double *value,
                const double *gradient) {
              const double share = JxW / discretization_->volume(b);
              for (unsigned int c = 0; c < dim; ++c)
                mine[b * width + at + c] += share * value[c];
              if (stress) {
                const auto sigma = discretization_->stress(b, gradient);
                for (unsigned int c = 0; c < 6; ++c)
                  mine[b * width + 9 + c] += share * sigma[c];
              }
            });
        };
        average(state_.displacement, 3, true);
        average(state_.velocity, 6, false);
        std::vector<int> counts(communicator_.size()),
          offsets(communicator_.size(), 0);
        const int count = int(mine.size());
        MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT,
                      communicator_.mpi());
        for (std::size_t r = 1; r < counts.size(); ++r)
          offsets[r] = offsets[r - 1] + counts[r - 1];
        std::vector<double> all(offsets.back() + counts.back());
        MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(),
                       counts.data(), offsets.data(), MPI_DOUBLE,
                       communicator_.mpi());
        cells.resize(all.size() / width);
        for (std::size_t k = 0; k < cells.size(); ++k) {
          const double *in = all.data() + k * width;
          CellState &cell = cells[k];
          std::copy_n(in, 3, cell.centre.begin());
          std::copy_n(in + 3, 3, cell.displacement.begin());
          std::copy_n(in + 6, 3, cell.velocity.begin());
          std::copy_n(in + 9, 6, cell.stress.begin());
          cell.volume = in[15];
        }
        // the numbers of cells depend on the ranks, their places do not
        std::sort(cells.begin(), cells.end(),
                  [](const CellState &a, const CellState &b) {
                    return a.centre < b.centre;
                  });
        view.cells = &cells;
      }
      input_.verification->observe(view);
    }

    template <int dim>
    void Simulation<dim>::write_if_due(const bool last)
    {
      const double start = cpu_seconds();
      const auto &output = input_.output;
      const bool due =
        last || state_.step == 0 ||
        (output.fields_every > 0. &&
         state_.time >= next_fields_ * (1. - 1e-12)) ||
        (output.fields_every_steps > 0 &&
         state_.step % output.fields_every_steps == 0);
      if (due && !(last && fields_current_)) {
        if (output.fields_every > 0.)
          next_fields_ =
            (std::floor(state_.time / output.fields_every * (1. + 1e-12)) +
             1.) *
            output.fields_every;
        if (output.fields)
          fields_->write(state_, last_step_, *fragments_);
        if (output.report) {
          snapshots_.push_back(fields_->snapshot(state_, *fragments_));
          if (snapshots_.size() > 24) // keep every second one
            for (std::size_t k = 1; k < snapshots_.size(); ++k)
              snapshots_.erase(snapshots_.begin() + long(k));
        }
      }
      fields_current_ = due;
      output_cpu_ += cpu_seconds() - start;
    }

    /** Relative errors of the fields against the exact solution, at the end. */
    template <int dim>
    void Simulation<dim>::norms()
    {
      const auto &exact = *input_.verification;
      const std::size_t n = discretization_->bodies().size();
      // per body: error and reference of u (L2), v (L2, L1), stress (L2)
      std::vector<double> terms(8 * n, 0.);
      const auto visit = [&](const std::vector<double> &unknowns,
                             const bool velocity) {
        discretization_->visit_quadrature(
          discretization_->to_nodal(unknowns),
          [&](const unsigned int b, const dealii::Point<dim> &x,
              const double JxW, const double *value, const double *gradient) {
            std::array<double, 3> position{};
            for (unsigned int c = 0; c < dim; ++c)
              position[c] = x[c];
            const auto reference =
              velocity ? exact.velocity(position, state_.time)
                       : exact.displacement(position, state_.time);
            const unsigned int row = velocity ? 2 : 0;
            for (unsigned int c = 0; c < dim; ++c) {
              const double error = value[c] - reference[c];
              terms[row * n + b] += JxW * error * error;
              terms[(row + 1) * n + b] += JxW * reference[c] * reference[c];
              if (velocity) {
                terms[4 * n + b] += JxW * std::abs(error);
                terms[5 * n + b] += JxW * std::abs(reference[c]);
              }
            }
            if (!velocity && exact.has_stress()) {
              const auto sigma = discretization_->stress(b, gradient);
              const auto known = exact.stress(position, state_.time);
              for (unsigned int c = 0; c < 6; ++c) {
                terms[6 * n + b] +=
                  JxW * (sigma[c] - known[c]) * (sigma[c] - known[c]);
                terms[7 * n + b] += JxW * known[c] * known[c];
              }
            }
          });
      };
      visit(state_.displacement, false);
      visit(state_.velocity, true);
      const auto s = communicator_.sums(terms.data(), 8, n);
      const auto relative = [](const double error, const double reference) {
        return reference > 0. ? error / reference : error;
      };
      summary_.errors["displacement_L2"] =
        std::sqrt(relative(s[0], s[1]));
      summary_.errors["velocity_L2"] = std::sqrt(relative(s[2], s[3]));
      summary_.errors["velocity_L1"] = relative(s[4], s[5]);
      if (exact.has_stress())
        summary_.errors["stress_L2"] = std::sqrt(relative(s[6], s[7]));
    }

    template <int dim>
    void Simulation<dim>::finish(const std::string &failure)
    {
      write_if_due(true);
      if (progress_)
        progress_->finish();
      auto &s = summary_;
      s.completed = failure.empty();
      s.failure = failure;
      s.dimension = dim;
      s.steps = state_.step;
      s.cells = discretization_->n_global_cells();
      s.final_time = state_.time;
      s.energy = state_.energy;
      s.penetration_max = state_.penetration;
      s.penetration_bound =
        std::max(0., state_.penetration - state_.penetration_excess);
      s.positive_friction_work = state_.positive_friction_work;
      s.rigid_drift_max = state_.rigid_drift;
      s.fragments = fragments_->count();
      double bound = 0.;
      for (const double value : state_.penetration_bound)
        bound = std::max(bound, value);
      s.penetration_bound = communicator_.max(bound);

      const auto &stepper = stepper_->counters();
      const auto &dynamics = dynamics_->counters();
      auto &c = s.counters;
      c["solver_calls"] = double(stepper.solves);
      c["newton"] = double(stepper.newton);
      c["krylov"] = double(stepper.krylov);
      c["gauss_seidel_sweeps"] = double(stepper.sweeps);
      c["line_searches"] = double(stepper.line_searches);
      c["law_sweeps"] = double(stepper.law_sweeps);
      c["delassus_applications"] = double(dynamics.delassus);
      c["block_factorisations"] = double(dynamics.factorisations);
      c["global_factorisations"] = double(dynamics.global_factorisations);
      c["load_assemblies"] = double(stepper.load_assemblies);
      c["activation_rounds"] = double(stepper.activation_rounds);
      c["rejected_steps"] = rejected_;
      c["steps_beyond_uniqueness"] = beyond_unique_;
      c["penetration_excess"] = state_.penetration_excess;
      double cohesive = 0., frictional = 0., classes = 0.;
      for (std::size_t i = 0; i < discretization_->points().n_owned; ++i) {
        const auto &origin = discretization_->origins()[i];
        if (origin.kind == PointOrigin::Kind::interface) {
          const auto &block = input_.interfaces[origin.block];
          cohesive += block.law ? 1. : 0.;
          frictional += block.friction > 0. ? 1. : 0.;
        } else if (origin.kind == PointOrigin::Kind::obstacle)
          frictional += input_.obstacles[origin.block].friction > 0. ? 1. : 0.;
      }
      classes = double(discretization_->bodies().classes.size());
      c["cohesive_points"] = double(
        communicator_.sum_integer(static_cast<unsigned long long>(cohesive)));
      c["friction_points"] = double(communicator_.sum_integer(
        static_cast<unsigned long long>(frictional)));
      c["body_classes"] = communicator_.max(classes);
      for (const auto &[name, count] : switches_)
        c["switches_to_" + name] = count;

      if (input_.verification) {
        if (input_.verification->has_fields())
          norms();
        input_.verification->finish(s.errors);
      }
      s.wall_seconds = wall_seconds() - start_wall_;
      s.cpu_seconds = cpu_seconds();
      s.peak_memory_mb = peak_memory_mb();
      const auto &t = stepper_->timings();
      s.timings = {{"set-up", s.setup_seconds},
                   {"loads and free motion", t.assembly},
                   {"nonsmooth solve", t.solve},
                   {"update of bodies", t.update},
                   {"energy ledger", t.ledger},
                   {"output", output_cpu_}};
      if (!communicator_.is_root())
        return;
      const std::string &directory = input_.output.directory;
      write_summary(directory + "/summary.json", s);
      if (input_.output.report) {
        Report report;
        report.title = input_.title;
        report.description = input_.description;
        report.info = info_;
        report.summary = s;
        report.history = history_;
        report.reaction_names = reaction_names_;
        report.snapshots = snapshots_;
        report.parameters = input_.echo;
        write_report(directory + "/report.html", report);
      }
      if (options_.quiet)
        return;
      const double steps = std::max(1., double(s.steps));
      std::cout << fmt::format(
        "{} steps, {:.3g} s wall; residual {:.1e}, ledger defect {:.1e}, "
        "penetration {:.3g} (bound {:.3g})\n",
        s.steps, s.wall_seconds, s.residual_max, s.ledger_defect_max,
        s.penetration_max, s.penetration_bound);
      std::cout << fmt::format(
        "  per step: {:.3g} ms, Newton {:.2f}, Krylov {:.1f}, sweeps {:.1f}; "
        "rejected {}, beyond uniqueness {}\n",
        1e3 * (t.assembly + t.solve + t.update + t.ledger) / steps,
        double(stepper.newton) / steps, double(stepper.krylov) / steps,
        double(stepper.sweeps) / steps, rejected_, beyond_unique_);
      std::cout << "  time:";
      for (const auto &[name, seconds] : s.timings)
        std::cout << fmt::format(" {} {:.3g} s;", name, seconds);
      std::cout << fmt::format(
        "\n  energy: kinetic {:.6g}, elastic {:.6g}, cohesive {:.6g}, damage "
        "{:.6g}, friction {:.6g}, impact {:.6g}, numerical {:.3g}, work "
        "{:.6g}; broken area {:.4g}, fragments {}\n",
        s.energy.kinetic, s.energy.elastic, s.energy.cohesive, s.energy.damage,
        s.energy.friction, s.energy.impact, s.energy.numerical, s.energy.work,
        state_.broken_area, s.fragments);
      for (const auto &[name, value] : s.errors)
        std::cout << fmt::format("  {:<28} {:.6g}\n", name, value);
      std::cout << "  " << directory
                << (input_.output.report ? "/report.html\n" : "/\n");
    }

    template <int dim>
    int Simulation<dim>::run()
    {
      const double setup = cpu_seconds();
      if (!build())
        return exit_code::bad_input;
      summary_.dofs = communicator_.sum_integer(
        discretization_->bodies().n_dofs());
      summary_.interface_points =
        communicator_.sum_integer(discretization_->points().n_owned);
      if (input_.verification)
        try {
          input_.verification->initialise(input_);
        } catch (const std::runtime_error &error) {
          if (communicator_.is_root())
            print_problems({error.what()}, input_.file, "error");
          return exit_code::bad_input;
        }
      if (options_.check)
        return print_check<dim>(input_, *triangulation_, *discretization_,
                                control_->base_step(), communicator_);
      bool ours = true;
      if (communicator_.is_root())
        ours = claim_directory(input_.output.directory, options_.force);
      if (communicator_.any(!ours))
        return exit_code::bad_input;

      dynamics_->reinit(control_->step(), input_.time.theta);
      state_ = stepper_->initial_state();
      fragments_ =
        std::make_unique<Fragments<dim>>(*discretization_, communicator_);
      fragments_->update(state_);
      open_output();
      summary_.setup_seconds = cpu_seconds() - setup;

      std::signal(SIGINT, request_stop);
      std::signal(SIGTERM, request_stop);
      last_step_ = control_->step();
      write_if_due(false);
      HistoryRow start;
      start.energy = state_.energy;
      start.fragments = fragments_->count();
      start.reactions.assign(reaction_names_.size() * dim, 0.);
      history_.push_back(start);
      observe(start);

      State next = state_;
      while (!control_->finished()) {
        if (communicator_.any(stop_requested != 0)) {
          finish(fmt::format("stopped on request at t = {:.6g}", state_.time));
          return exit_code::stopped;
        }
        if (input_.time.step_kind == StepKind::automatic) {
          const double limit = 0.7 * stepper_->unique_step(state_);
          control_->limit(limit);
          control_->set_ceiling(limit);
        }
        const double h = control_->step();
        StepReport report;
        // the one place that catches StepRejected and shortens the step
        try {
          report = stepper_->advance(state_, h, next);
        } catch (const StepRejected &rejected) {
          ++rejected_;
          if (!control_->halve()) {
            const std::string text =
              std::string(rejected.what()) +
              fmt::format("; {} halvings did not help",
                          input_.time.maximum_halvings);
            if (communicator_.is_root())
              std::cerr << input_.file << ": " << text
                        << "\n  the last good state is in "
                        << input_.output.directory << "\n";
            finish(text);
            return exit_code::step_failed;
          }
          continue;
        }
        control_->accept();
        next.time = control_->time();
        std::swap(state_, next);
        last_step_ = h;
        beyond_unique_ += report.beyond_unique;
        for (const auto &name : report.solver.switches)
          ++switches_[name];
        fragments_->update(state_);
        record(report, h);
        write_if_due(false);
      }
      finish("");
      return exit_code::done;
    }
  } // namespace

  int run_scene(const SceneInput &input,
                const RunOptions &options,
                const MPI_Comm mpi)
  {
    const Communicator communicator(mpi);
    if (input.dimension == 2)
      return Simulation<2>(input, options, communicator).run();
    return Simulation<3>(input, options, communicator).run();
  }
} // namespace nsfd
