#include "read_scene.h"

#include "nonsmooth/solvers/contact_solvers.h"
#include "nsfd/adaptivity/indicator.h"
#include "nsfd/cohesive_laws/cohesive_law.h"
#include "nsfd/mesh/mesh_type.h"
#include "nsfd/obstacles/obstacle_shape.h"
#include "nsfd/postprocess/observable.h"
#include "nsfd/verification/verification_case.h"
#include "read_sections.h"
#include "time_integration/step_entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>

namespace nsfd
{
  namespace
  {
    const std::vector<std::string> plain_sections = {
        "Mesh",   "Discretization", "Loads",      "Time",     "Solver",
        "Output", "Verification",   "Adaptivity", "Constants"};
    const std::vector<std::string> block_kinds = {
        "Body",    "Material", "Interface", "Boundary",  "Obstacle",
        "Contact", "Pin",      "Indicator", "Observable"};
    /// of a study, which reads them itself, see study/study_input.h
    const std::vector<std::string> study_kinds = {"Study", "Vary"};

    std::vector<std::string> all_kinds()
    {
      std::vector<std::string> kinds = plain_sections;
      kinds.insert(kinds.end(), block_kinds.begin(), block_kinds.end());
      kinds.insert(kinds.end(), study_kinds.begin(), study_kinds.end());
      return kinds;
    }

    bool contains(const std::vector<std::string> &list, const std::string &word)
    {
      return std::find(list.begin(), list.end(), word) != list.end();
    }

    /** Sections that no part of the program reads. */
    void check_section_name(const ParameterSection &section,
                            InputErrors &errors)
    {
      const std::string &name = section.name();
      const std::string kind = section.kind();
      const bool is_block = name.find(':') != std::string::npos;
      if (contains(study_kinds, kind))
        return;
      if (contains(plain_sections, kind)) {
        if (is_block)
          errors.error(section.location(),
                       fmt::format("section `{}` takes no name", kind),
                       "write: subsection " + kind);
      } else if (contains(block_kinds, kind)) {
        if (section.block_name().empty())
          errors.error(
              section.location(),
              fmt::format("section `{}` needs a name", kind),
              fmt::format("write for example: subsection {}: first", kind));
      } else if (kind == "Path")
        errors.error(section.location(),
                     "section `Path` is for one point, not for a scene",
                     "run it with: nsfd law FILE.prm");
      else {
        const std::string nearest = nearest_name(kind, all_kinds());
        errors.error(
            section.location(),
            fmt::format("`{}` is not the name of a section", name),
            nearest.empty()
                ? "known are Mesh, Discretization, Time, Loads, Solver, "
                  "Output, Verification, Adaptivity, Constants, and "
                  "Body: ..., Material: ..., Interface: ..., "
                  "Boundary: ..., Obstacle: ..., Contact: ..., Pin: ..., "
                  "Indicator: ..., Observable: ..."
                : fmt::format("did you mean `{}{}`?", nearest,
                              contains(block_kinds, nearest)
                                  ? ": " + (section.block_name().empty()
                                                ? "name"
                                                : section.block_name())
                                  : ""));
      }
    }

    /** `motion`; a misspelt word says that large ones are meant, unless it is
     * near to `small`: what hangs on it is not blamed as well. */
    bool read_large_motion(SectionReader &reader)
    {
      const std::string motion =
          reader.word("motion", "small",
                      "small, or large: rotations and strains of any size");
      const std::vector<std::string> known = {"small", "large"};
      if (!contains(known, motion))
        reader.error(
            "motion",
            fmt::format("motion = {} is neither small nor large", motion),
            did_you_mean(motion, known));
      return motion != "small" && nearest_name(motion, known) != "small";
    }

    void read_top(ParameterFile &file, InputErrors &errors, SceneInput &scene)
    {
      SectionReader reader(file.top(), errors);
      scene.dimension = reader.integer("dimension", "2", 2, 3, "2 or 3");
      if (scene.dimension == 2) {
        const std::string plane = reader.choice(
            "plane", "strain", {"strain", "stress", "axisymmetric"},
            "strain, stress, or axisymmetric: x is the radius, y the height, "
            "measures are per radian");
        scene.plane_stress = plane == "stress";
        scene.axisymmetric = plane == "axisymmetric";
      } else
        reader.refuse({"plane"}, "plane strain, plane stress and axisymmetric "
                                 "bodies are for dimension = 2");
      scene.large_motion = read_large_motion(reader);
    }

    /** "# name - sentence" becomes title and description. */
    void read_opening(const ParameterFile &file, SceneInput &scene)
    {
      std::string paragraph;
      for (const std::string &line : file.opening_comment()) {
        const std::size_t begin = line.find_first_not_of("# \t");
        if (begin == std::string::npos)
          break; // an empty comment line ends the paragraph
        paragraph += (paragraph.empty() ? "" : " ") + line.substr(begin);
      }
      const std::size_t dash = paragraph.find(" - ");
      const bool has_title = dash != std::string::npos && dash < 80;
      scene.title = has_title ? paragraph.substr(0, dash) : scene.file;
      scene.description = has_title ? paragraph.substr(dash + 3) : paragraph;
    }

    /** In place of what the file or the command line says. */
    void put(ParameterSection &section, const std::string &entry,
             const std::string &value)
    {
      const ParameterEntry *old = section.find(entry);
      const SourceLocation place =
          old ? old->value.location() : section.location();
      section.assign({entry, {value, place}, old ? old->name_location : place});
    }

    std::unique_ptr<SceneInput> read_parsed(ParameterFile &file,
                                            const std::string &name,
                                            InputErrors &errors)
    {
      for (const ParameterSection *section : file.sections())
        check_section_name(*section, errors);

      auto scene = std::make_unique<SceneInput>();
      scene->file = name;
      read_opening(file, *scene);
      read_constants(file, errors);
      read_top(file, errors, *scene);
      if (!read_plug_ins(file, errors, "nsfd", name))
        return nullptr;
      look_at_scheme(file, *scene);
      read_mesh(file, errors, *scene);
      read_materials(file, errors, *scene);
      read_interfaces(file, errors, *scene);
      read_discretization(file, errors, *scene);
      read_boundaries(file, errors, *scene);
      read_obstacles(file, errors, *scene);
      read_events(file, errors, *scene);
      read_contacts(file, errors, *scene);
      read_pins(file, errors, *scene);
      read_loads(file, errors, *scene);
      read_time(file, errors, *scene);
      read_solver(file, errors, *scene);
      read_output(file, errors, *scene);
      read_verification(file, errors, *scene);
      read_adaptivity(file, errors, *scene);
      read_observables(file, errors, *scene);
      if (scene->axisymmetric)
        refuse_axisymmetric(file, errors, *scene);
      file.report_stray(errors);
      if (!errors.has_errors())
        check_memory(file, errors, *scene);
      if (errors.has_errors())
        return nullptr;
      scene->echo = file.print();
      return scene;
    }

    bool has_entry(const ParameterFile &file, const std::string &section,
                   const std::string &name, const std::string &value = "")
    {
      const ParameterSection *found = file.find(section);
      const ParameterEntry *entry = found ? found->find(name) : nullptr;
      return entry && (value.empty() || entry->value.text() == value);
    }

    /** Who names no scheme leaves it to the program where motions are large,
     * as impacts go through with explicit steps, and where no step is given. */
    bool leaves_scheme(ParameterFile &file)
    {
      const ParameterEntry *motion = file.top().find("motion");
      return (motion && motion->value.text() == "large") ||
             !has_entry(file, "Time", "step");
    }

    /** A file with what the command line says; false if it cannot be read. */
    using Parse = std::function<bool(ParameterFile &, InputErrors &)>;
    using Entries = std::vector<std::pair<std::string, std::string>>;

    std::unique_ptr<SceneInput> read_with(const Entries &chosen,
                                          const Parse &parse,
                                          const std::string &name,
                                          InputErrors &errors)
    {
      ParameterFile parsed;
      parse(parsed, errors);
      for (const auto &[entry, value] : chosen)
        put(*parsed.find("Time"), entry, value);
      return read_parsed(parsed, name, errors);
    }

    /** A scene that names no scheme, with explicit steps; null if it cannot. */
    std::shared_ptr<const AutomaticScheme>
    read_alternative(const Parse &parse, const std::string &name)
    {
      InputErrors ignored;
      auto choice = std::make_shared<AutomaticScheme>();
      choice->longest_steps = read_with(
          {{"scheme", "explicit"}, {"step", "auto"}}, parse, name, ignored);
      return choice->longest_steps ? choice : nullptr;
    }

    /** What is wrong in @p some is a part of what is wrong in @p all. */
    bool is_part_of(const InputErrors &some, const InputErrors &all)
    {
      const auto &list = all.diagnostics();
      const auto is_there = [&](const Diagnostic &one) {
        return std::any_of(list.begin(), list.end(), [&](const auto &other) {
          return other.message == one.message;
        });
      };
      return some.n_errors() < all.n_errors() &&
             std::all_of(some.diagnostics().begin(), some.diagnostics().end(),
                         is_there);
    }

    /**
     * A scene with `scheme = auto`, with implicit steps and with explicit ones:
     * which of them is predicted to cost less is known with the mesh.
     */
    std::unique_ptr<SceneInput> read_automatic(const Parse &parse,
                                               const std::string &name,
                                               const bool is_default,
                                               const bool has_step,
                                               InputErrors &errors)
    {
      const auto read = [&](const Entries &chosen, InputErrors &found) {
        return read_with(chosen, parse, name, found);
      };
      InputErrors of_implicit, of_explicit, of_given;
      auto scene = read({{"scheme", "moreau-jean"}}, of_implicit);
      auto choice = std::make_shared<AutomaticScheme>();
      std::unique_ptr<SceneInput> longest =
          read({{"scheme", "explicit"}, {"step", "auto"}}, of_explicit);
      const bool only_explicit = !scene && longest;
      // what is wrong with both: some entries are for explicit steps alone
      const bool is_explicit =
          only_explicit || (!scene && is_part_of(of_explicit, of_implicit));
      for (const Diagnostic &one :
           (is_explicit ? of_explicit : of_implicit).diagnostics())
        errors.add(one);
      if (only_explicit) {
        longest->scheme_choice =
            "explicit: an entry of the scene is for explicit steps alone";
        return longest;
      }
      // of rigid bodies alone explicit steps cost no less
      if (!scene || (is_default && all_rigid(*scene)))
        return scene;
      for (const Diagnostic &one : of_explicit.diagnostics())
        if (one.is_error() && choice->refused.empty())
          choice->refused = one.message;
      // printed as it was written: what is chosen depends on the mesh
      choice->implicit_echo = scene->echo;
      const std::size_t entry = scene->echo.find("set scheme"),
                        value = scene->echo.find("moreau-jean", entry);
      scene->echo.replace(value, std::strlen("moreau-jean"), "auto");
      // of rigid bodies alone no step is the longest
      if (has_step && (longest || all_rigid(*scene)))
        choice->given_steps = read({{"scheme", "explicit"}}, of_given);
      choice->longest_steps = std::move(longest);
      scene->automatic = std::move(choice);
      return scene;
    }

    std::unique_ptr<SceneInput>
    read(const Parse &parse, const std::string &name, InputErrors &errors)
    {
      ParameterFile parsed;
      InputErrors found;
      const bool can_be_read = parse(parsed, found);
      const bool names_none = can_be_read && parsed.find("Time") &&
                              !has_entry(parsed, "Time", "scheme");
      if (can_be_read && (has_entry(parsed, "Time", "scheme", "auto") ||
                          (names_none && leaves_scheme(parsed))))
        return read_automatic(parse, name, names_none,
                              has_entry(parsed, "Time", "step"), errors);
      for (const Diagnostic &one : found.diagnostics())
        errors.add(one);
      if (!can_be_read)
        return nullptr;
      auto scene = read_parsed(parsed, name, errors);
      if (scene && names_none)
        scene->alternative = read_alternative(parse, name);
      return scene;
    }

    void override_entries(ParameterFile &file,
                          const std::vector<Assignment> &assignments,
                          InputErrors &errors)
    {
      for (const Assignment &one : assignments)
        file.override_entry(one.text, all_kinds(), errors, one.file);
    }

    std::vector<Assignment>
    on_command_line(const std::vector<std::string> &overrides)
    {
      std::vector<Assignment> all;
      for (const std::string &text : overrides)
        all.push_back({text});
      return all;
    }
  } // namespace

  std::unique_ptr<SceneInput>
  read_scene(const std::string &file, const std::vector<std::string> &overrides,
             InputErrors &errors)
  {
    return read_case_scene(file, on_command_line(overrides), errors);
  }

  std::unique_ptr<SceneInput>
  read_case_scene(const std::string &file,
                  const std::vector<Assignment> &assignments,
                  InputErrors &errors)
  {
    return read(
        [&](ParameterFile &parsed, InputErrors &found) {
          // what cannot be read would look like a file in which all is missing
          if (!parsed.read_file(file, found))
            return false;
          override_entries(parsed, assignments, found);
          return true;
        },
        file, errors);
  }

  std::unique_ptr<SceneInput>
  read_scene_text(const std::string &text, const std::string &name,
                  const std::vector<std::string> &overrides,
                  InputErrors &errors)
  {
    return read(
        [&](ParameterFile &parsed, InputErrors &found) {
          parsed.read_text(text, name, found);
          override_entries(parsed, on_command_line(overrides), found);
          return true;
        },
        name, errors);
  }

  std::vector<NamedPart> named_parts()
  {
    std::vector<NamedPart> parts;
    const auto append = [&parts](const std::string &kind, const auto &list) {
      for (const auto &entry : list)
        parts.push_back({kind, entry.name, entry.text});
    };
    append("material model", known_bulk_models());
    append("interface law", known_plain_laws());
    const auto append_registered = [&parts](const std::string &kind,
                                            const auto &registry) {
      for (const auto &[name, entry] : registry.entries())
        parts.push_back({kind, name, entry.text,
                         entry.examples.empty() ? "" : entry.examples.front(),
                         entry.plug_in});
    };
    append_registered("cohesive law", CohesiveLawRegistry::instance());
    append_registered("verification case", VerificationRegistry::instance());
    append_registered("indicator", IndicatorRegistry::instance());
    append_registered("observable", ObservableRegistry::instance());
    for (const std::string &name : obstacle_shape_names())
      parts.push_back(
          {"obstacle shape", name,
           ObstacleShapeRegistry::instance().entries().at(name).text});
    for (const std::string &name : mesh_type_names())
      parts.push_back(
          {"mesh", name, MeshTypeRegistry::instance().entries().at(name).text});
    append("time scheme", known_time_schemes());
    append("solver", known_solvers());
    for (const auto &[name, text] : contact_solvers())
      parts.push_back({"solver of stored problems", name, text});
    return parts;
  }
} // namespace nsfd
