#include "interface_entries.h"
#include "law_of_shape.h"
#include "read_sections.h"
#include "temperature_factors.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace nsfd
{
  namespace
  {
    const std::vector<NamedText> plain_laws = {
        {"joined",
         "common nodes in explicit steps; elsewhere bonded if where = "
         "all or other faces are, else rigid"},
        {"rigid", "faces stay closed, without any compliance"},
        {"bonded", "the same by common nodes, and rigid where there are none"},
        {"elastic", "springs C_N, C_T that never break"},
        {"contact", "unilateral contact and Coulomb friction only"},
    };

    /**
     * What joins cells of implicit steps: rigid rows on all faces make W
     * singular, and tractions ambiguous, but there are no common nodes where
     * steps are iterations.
     */
    std::string joint(const InterfaceInput &input, const SceneInput &scene)
    {
      const bool bonds = !scene.iterates() && !no_body_deforms(scene) &&
                         input.where.kind == Where::Kind::all;
      return bonds ? "bonded" : "rigid";
    }

    /** The law of a block, checked; empty if nothing more can be read. */
    std::string read_law_name(SectionReader &reader)
    {
      const auto value = reader.raw(
          "law", "",
          "joined, rigid, bonded, elastic, contact or a cohesive law",
          "joined");
      if (!value) {
        reader.accept_everything();
        return "";
      }
      const std::string name = collapse_blanks(value->text());
      std::vector<std::string> known = CohesiveLawRegistry::instance().names();
      for (const NamedText &law : plain_laws)
        known.push_back(law.name);

      if (std::find(known.begin(), known.end(), name) == known.end())
        reader.error(
            "law", fmt::format("law = {} is not a law", name),
            law_of_shape(name).empty()
                ? advice_on_name(name, known, "`nsfd --list` prints all names")
                : law_of_shape(name) + "; `nsfd --list` prints all names");
      else
        return name;
      reader.accept_everything();
      return "";
    }

    void read_springs(SectionReader &reader, InterfaceInput &input)
    {
      input.normal_stiffness =
          reader.number("normal stiffness", "", units::stiffness_per_area,
                        Range::positive(), "C_N in Pa/m");
      const std::string tangential = "tangential stiffness";
      const std::string text = "C_T in Pa/m; default C_N";
      input.tangential_stiffness =
          reader.optional(tangential, text)
              ? reader.number(tangential, "", units::stiffness_per_area,
                              Range::positive(), text)
              : input.normal_stiffness;
    }

    void read_contact(SectionReader &reader, const SceneInput &scene,
                      InterfaceInput &input)
    {
      input.friction = read_friction(reader);
      input.restitution =
          reader.number("restitution", "0", units::none, Range::closed(0., 1.),
                        "of Newton's impact law, where beta = 0");
      input.sliding = read_sliding(reader, input.friction);
      input.heat.friction =
          read_friction_factor(reader, scene, input.friction, input.sliding);
    }

    /** Common nodes are for bodies of Hooke's law and small strain. */
    void refuse_bonds(SectionReader &reader, const SceneInput &scene,
                      const std::string &name)
    {
      reader.error(
          name,
          fmt::format("{} = bonded joins bodies {}, and the scene has {}", name,
                      scene.large_motion ? "that turn and strain little"
                                         : "without history",
                      scene.large_motion ? "motion = large"
                                         : history_dependent_model(scene)),
          "write joined");
    }

    void check_intact_faces(SectionReader &reader, const InterfaceInput &input,
                            const std::string &name, const SceneInput &scene)
    {
      const bool extrinsic = input.law && input.law->extrinsic();
      const bool joined = name == "rigid" || name == "bonded";
      if (extrinsic && !joined)
        reader.error("intact faces",
                     fmt::format("intact faces = {} needs a stiffness, and the "
                                 "extrinsic law {} has none",
                                 name, input.law_name),
                     scene.iterates()
                         ? "write rigid, or take an intrinsic law"
                         : "write rigid or bonded, or take an intrinsic law");
      else if (extrinsic && name == "bonded" && scene.iterates())
        refuse_bonds(reader, scene, "intact faces");
      else if (extrinsic && !scene.iterates() && !no_body_deforms(scene) &&
               name == "rigid" && input.where.kind == Where::Kind::all)
        reader.error("intact faces",
                     fmt::format("intact faces = rigid with where = all and "
                                 "the law {}: rigid rows on all faces make the "
                                 "Delassus matrix W singular",
                                 input.law_name),
                     "write bonded, or name the faces that may break and give "
                     "the others law = bonded");
      else if (!extrinsic && joined)
        reader.error("intact faces",
                     fmt::format("intact faces = {} contradicts the stiffness "
                                 "of the law {}",
                                 name, input.law_name),
                     "write spring or unilateral, or take an extrinsic law");
    }

    IntactFaces read_intact_faces(SectionReader &reader,
                                  const InterfaceInput &input,
                                  const SceneInput &scene)
    {
      const bool extrinsic = input.law && input.law->extrinsic();
      std::string name = reader.choice(
          "intact faces", extrinsic ? "joined" : "spring",
          {"spring", "unilateral", "joined", "rigid", "bonded"},
          scene.iterates()
              ? "while beta = 1: spring or unilateral (intrinsic laws), joined "
                "(extrinsic laws)"
              : "while beta = 1: spring or unilateral (intrinsic laws), joined "
                "(extrinsic laws: bonded if where = all or other faces are, "
                "else rigid)");
      if (name == "joined")
        name = joint(input, scene);
      else if (name == "bonded" && no_body_deforms(scene))
        name = "rigid"; // without nodes
      check_intact_faces(reader, input, name, scene);
      if (name == "bonded")
        return IntactFaces::bonded;
      if (name == "unilateral")
        return IntactFaces::unilateral;
      return name == "rigid" || extrinsic ? IntactFaces::rigid
                                          : IntactFaces::spring;
    }

    void read_crack_pressure(SectionReader &reader, InterfaceInput &input)
    {
      const std::string
          name = "crack pressure",
          text = "Pa, of x, y, z, t: pushes the crack faces of broken "
                 "points apart";
      const std::string threshold = "pressure threshold",
                        threshold_text =
                            "beta up to which a point counts as broken";
      if (!reader.optional(name, text)) {
        reader.refuse({threshold}, "there is no `crack pressure`");
        if (input.law) // named next to the entry that it belongs to
          reader.optional(threshold, threshold_text);
        return;
      }
      input.crack_pressure = reader.expression(name, "", units::pressure, text);
      if (!input.law)
        return;
      input.pressure_threshold =
          reader.number(threshold, fmt::format("{}", input.broken_beta()),
                        units::none, {0., 1., false, true}, threshold_text);
    }

    /** Of faces that part, in a scene with heat. */
    void read_heat(SectionReader &reader, const SceneInput &scene,
                   InterfaceInput &input)
    {
      const std::string conductance = "contact conductance",
                        gap = "gap conductivity",
                        text = "W/(m^2 K), of parted faces that are closed; "
                               "default: they conduct as the bodies do";
      if (!scene.has_heat()) {
        reader.refuse({conductance, gap}, "no material has a heat capacity");
        return;
      }
      if (reader.optional(conductance, text))
        input.heat.conductance = reader.number(
            conductance, "", units::conductance, Range::positive(), text);
      input.heat.gap_conductivity = reader.number(
          gap, "0", units::conductivity, Range::non_negative(),
          "W/(m K), of what fills parted faces that are open; 0: nothing");
    }

    /** Where a law that heals is not known. */
    void check_healing(SectionReader &reader, const InterfaceInput &input,
                       const SceneInput &scene)
    {
      if (!input.law || !input.law->heals())
        return;
      if (scene.large_motion)
        reader.error("healing time",
                     "faces heal in small motions alone: in large ones those "
                     "that are pressed are not those that parted",
                     "remove it, or write motion = small");
      else if (scene.has_history())
        reader.error("healing time",
                     fmt::format("faces do not heal yet in scenes with {}",
                                 history_dependent_model(scene)),
                     "remove it");
      if (input.sliding.lifts())
        reader.error("healing time",
                     "faces with dilatancy or wear do not heal: pressed, they "
                     "may be open",
                     "remove one of them");
    }

    InterfaceInput read_interface(SectionReader &reader,
                                  const SceneInput &scene)
    {
      InterfaceInput input;
      input.name = reader.block_name();
      input.where = read_where(
          reader, "all", WhereUse::interior_faces, scene,
          "all, between materials [a, b], a group or an expression of x, y, z");
      input.law_name = read_law_name(reader);
      if (input.law_name.empty())
        return input;
      if (input.law_name == "joined")
        input.law_name = joint(input, scene);
      else if (input.law_name == "bonded" && no_body_deforms(scene))
        input.law_name = "rigid"; // without nodes
      if (input.law_name == "rigid" || input.law_name == "bonded") {
        input.intact = input.law_name == "rigid" ? IntactFaces::rigid
                                                 : IntactFaces::bonded;
        if (input.law_name == "bonded" && scene.iterates())
          refuse_bonds(reader, scene, "law");
        const std::string reason =
            fmt::format("faces of the law `{}` never open", input.law_name);
        reader.refuse({"friction", "restitution", "friction exponent", "broken",
                       "intact faces", "crack pressure", "pressure threshold",
                       "dilatancy", "dilatancy saturation", "wear coefficient",
                       "contact conductance", "gap conductivity",
                       "friction at temperatures"},
                      reason);
        reader.refuse(cohesive_entries(), reason);
        refuse_initial_stress(reader, reason);
        return input;
      }
      input.initial_stress = read_initial_traction(reader, scene);
      if (input.law_name == "contact") {
        read_contact(reader, scene, input);
        read_crack_pressure(reader, input);
        read_heat(reader, scene, input);
        const std::string reason =
            "faces of the law `contact` carry no cohesion";
        reader.refuse({"friction exponent", "broken", "intact faces"}, reason);
        reader.refuse(cohesive_entries(), reason);
        return input;
      }
      if (input.law_name == "elastic") {
        read_springs(reader, input);
        reader.refuse(cohesive_entries(),
                      "the springs of `elastic` never break");
      } else
        read_cohesive_block(reader, scene, input);
      read_contact(reader, scene, input);
      check_lift(reader, input);
      check_healing(reader, input, scene);
      read_damage_start(reader, input);
      input.intact = read_intact_faces(reader, input, scene);
      read_crack_pressure(reader, input);
      read_heat(reader, scene, input);
      return input;
    }
  } // namespace

  std::vector<NamedText> known_plain_laws() { return plain_laws; }

  std::shared_ptr<const CohesiveLaw> read_cohesive_law(SectionReader &reader,
                                                       const std::string &name)
  {
    const unsigned int n_before = reader.errors().n_errors();
    try {
      return CohesiveLawRegistry::instance().create(name, reader);
    } catch (const std::exception &exception) {
      // numbers that stand in for wrong ones need not make a law
      if (reader.errors().n_errors() == n_before)
        reader.error("law",
                     fmt::format("law = {}: {}", name, exception.what()));
    }
    return nullptr;
  }

  double read_friction(SectionReader &reader)
  {
    return reader.number("friction", "0", units::none, Range::non_negative(),
                         "coefficient of Coulomb friction");
  }

  bool read_plateau(SectionReader &reader, const CohesiveLaw *law,
                    const std::string &law_name)
  {
    const std::string name = "unloading";
    if (law && law->adds_openings()) {
      reader.refuse({name},
                    fmt::format("the law {} keeps its traction while it "
                                "closes: it has no elasticity",
                                law_name));
      return true;
    }
    if (law && !law->extrinsic()) {
      reader.refuse({name}, fmt::format("the law {} is intrinsic and closes "
                                        "on its secant",
                                        law_name));
      return false;
    }
    return reader.choice(name, "secant", {"secant", "plateau"},
                         "extrinsic laws: secant to the origin, or plateau "
                         "(the traction stays while it closes)") == "plateau";
  }

  SlidingInput read_sliding(SectionReader &reader, const double friction)
  {
    SlidingInput sliding;
    sliding.dilatancy =
        reader.number("dilatancy", "0", units::none, Range::non_negative(),
                      "tan(psi): sliding by s opens the contact by s tan(psi)");
    const std::string name = "dilatancy saturation",
                      text = "m: largest opening by dilatancy; default: none";
    if (sliding.dilatancy == 0.)
      reader.refuse({name}, "there is no `dilatancy`");
    else if (reader.optional(name, text))
      sliding.saturation =
          reader.number(name, "", units::length, Range::positive(), text);
    if (sliding.dilatancy > friction)
      reader.error("dilatancy",
                   fmt::format("dilatancy = {:g} is above friction = {:g}: "
                               "sliding would give energy",
                               sliding.dilatancy, friction),
                   "write at most the friction coefficient, which counts the "
                   "climb");
    sliding.wear = read_wear(reader);
    return sliding;
  }

  double read_wear(SectionReader &reader)
  {
    return reader.number(
        "wear coefficient", "0", units::wear_coefficient, Range::non_negative(),
        "k in 1/Pa of Archard's law: the gap grows by k p_N |U_T|");
  }

  double read_friction_exponent(SectionReader &reader, const CohesiveLaw *law)
  {
    // a law that adds openings has Coulomb friction beside it all the time
    const double otherwise = !law                   ? 1.
                             : law->adds_openings() ? 0.
                                                    : law->friction_exponent();
    return reader.number("friction exponent", fmt::format("{:g}", otherwise),
                         units::none, Range::non_negative(),
                         "s of kappa = (1 - beta)^s; 0: full friction always");
  }

  namespace
  {
    /**
     * Faces that the block only calls joined are so by common nodes where
     * others are: rigid rows beside them would cost a solve of all rows.
     */
    void share_nodes(const ParameterSection &block, InterfaceInput &input)
    {
      const auto says = [&block](const std::string &name,
                                 const bool without_entry) {
        const ParameterEntry *entry = block.find(name);
        return entry ? entry->value.text() == "joined" : without_entry;
      };
      if (input.intact != IntactFaces::rigid)
        return;
      if (input.law && input.law->extrinsic() && says("intact faces", true))
        input.intact = IntactFaces::bonded;
      else if (says("law", false)) {
        input.law_name = "bonded";
        input.intact = IntactFaces::bonded;
      }
    }

    /**
     * In a scene with equilibria an intact body is one body of finite elements
     * with common nodes, whatever word joins its cells, or else of rigid
     * joints: interior points need the matrices of cells, path = local asks for
     * them.
     */
    bool may_share_nodes(const ParameterFile &file)
    {
      const ParameterSection *solver = file.find("Solver");
      const auto asks_for = [solver](const char *entry, const char *value) {
        const ParameterEntry *found = solver ? solver->find(entry) : nullptr;
        return found && found->value.text() == value;
      };
      return !file.find("Adaptivity") &&
             !asks_for("method", "interior point") &&
             !asks_for("path", "local");
    }
  } // namespace

  bool no_body_deforms(const SceneInput &scene)
  {
    return !scene.materials.empty() &&
           std::all_of(scene.materials.begin(), scene.materials.end(),
                       [](const MaterialInput &m) { return m.rigid; });
  }

  void read_interfaces(ParameterFile &file, InputErrors &errors,
                       SceneInput &scene)
  {
    const auto blocks = file.open_blocks("Interface");
    for (ParameterSection *block : blocks) {
      SectionReader reader(*block, errors);
      scene.interfaces.push_back(read_interface(reader, scene));
    }
    const auto &scheme = scene.time.scheme;
    if (scene.has_bonded_faces() && !scheme.at_nodes)
      for (std::size_t b = 0; b < blocks.size(); ++b)
        share_nodes(*blocks[b], scene.interfaces[b]);
    if (scene.statics && !scene.iterates()) {
      const bool shares = may_share_nodes(file);
      scene.equilibria_at_nodes = shares;
      for (InterfaceInput &interface : scene.interfaces)
        if (shares
                ? interface.intact == IntactFaces::rigid
                : !scheme.at_nodes && interface.intact == IntactFaces::bonded) {
          interface.intact = shares ? IntactFaces::bonded : IntactFaces::rigid;
          if (!interface.law)
            interface.law_name = shares ? "bonded" : "rigid";
        }
    }
    if (scene.interfaces.empty())
      errors.error(file.location(),
                   "no Interface block says what holds the faces together",
                   "add for example: subsection Interface: all, with `set law "
                   "= rigid`");
  }
} // namespace nsfd
