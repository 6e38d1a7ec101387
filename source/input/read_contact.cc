#include "read_sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace nsfd
{
  namespace
  {
    /** Two names of materials, in their order. */
    using Pair = std::pair<std::string, std::string>;

    /** The blocks of a kind; none, and reported, if motions are small. */
    std::vector<ParameterSection *> open_large(ParameterFile &file,
                                               const std::string &kind,
                                               const std::string &otherwise,
                                               InputErrors &errors,
                                               const SceneInput &scene)
    {
      auto blocks = file.open_blocks(kind);
      if (scene.large_motion)
        return blocks;
      for (ParameterSection *block : blocks) {
        errors.error(
            block->location(),
            fmt::format("section `{}` needs motion = large", block->name()),
            "write at the top: set motion = large, or " + otherwise);
        block->accept_everything();
      }
      return {};
    }

    constexpr const char *nothing = "none";

    /** `all`, `[a, b]`, brackets optional; or `none`. */
    std::array<std::string, 2> read_pair(SectionReader &reader,
                                         const SceneInput &scene)
    {
      const auto value = reader.raw(
          "between", "all",
          "all, none, or two materials: [a, b], in any order; the first block "
          "that holds for two bodies is theirs, beside others they do not "
          "touch");
      const std::string text = value ? collapse_blanks(value->text()) : "all";
      if (text == "all")
        return {};
      if (text == nothing)
        return {nothing, nothing};
      return read_two_materials(reader, "between", text, text, "[a, b]", scene);
    }

    std::vector<Pair> pairs_of(const ContactInput &contact,
                               const SceneInput &scene)
    {
      if (!contact.materials[0].empty())
        return {std::minmax(contact.materials[0], contact.materials[1])};
      std::vector<Pair> pairs;
      for (const MaterialInput &a : scene.materials)
        for (const MaterialInput &b : scene.materials)
          pairs.push_back(std::minmax(a.name, b.name));
      return pairs;
    }

    /** Every pair belongs to the first block that names it: one that gets none
     * is a mistake. @p owners are the blocks of the pairs so far. */
    void claim_pairs(SectionReader &reader, const ContactInput &contact,
                     const SceneInput &scene,
                     std::map<Pair, std::string> &owners)
    {
      bool any = false;
      const std::vector<Pair> pairs = pairs_of(contact, scene);
      for (const Pair &pair : pairs)
        any = owners.emplace(pair, contact.name).second || any;
      if (any || pairs.empty())
        return;
      const Pair &first = pairs.front();
      reader.error("between",
                   fmt::format("section `{}` never holds: `Contact: {}` comes "
                               "first for {} and {}{}",
                               reader.section_name(), owners.at(first),
                               first.first, first.second,
                               pairs.size() > 1 ? ", and so on" : ""),
                   "remove it, or move it up");
    }

    ContactInput read_contact(SectionReader &reader, const SceneInput &scene)
    {
      ContactInput contact;
      contact.name = reader.block_name();
      contact.materials = read_pair(reader, scene);
      contact.friction = read_friction(reader);
      contact.restitution =
          reader.number("restitution", "0", units::none, Range::closed(0., 1.),
                        "of Newton's impact law");
      contact.sliding.wear = read_wear(reader);
      reader.refuse({"dilatancy", "dilatancy saturation"},
                    "dilatancy is of the two sides of one face: Interface "
                    "blocks have it");
      return contact;
    }

    /** All bodies are rigid, and there are faces that may open or several
        bodies: a scene that makes no sense if they do not touch. */
    bool is_of_blocks(const SceneInput &scene)
    {
      return no_body_deforms(scene) &&
             (scene.bodies.size() > 1 ||
              std::any_of(scene.interfaces.begin(), scene.interfaces.end(),
                          [](const auto &block) { return block.may_open(); }));
    }

    /**
     * What touches where no block says so: all surfaces, with what the faces
     * that may open have in common.
     */
    void touch_by_default(ParameterFile &file, InputErrors &errors,
                          SceneInput &scene)
    {
      ContactInput contact;
      contact.name = "all";
      contact.is_default = true;
      const InterfaceInput *first = nullptr;
      for (const InterfaceInput &block : scene.interfaces) {
        if (!block.may_open())
          continue;
        if (!first) {
          first = &block;
          contact.friction = block.friction;
          contact.restitution = block.restitution;
        }
        if (block.friction == first->friction &&
            block.restitution == first->restitution)
          continue;
        errors.error(
            file.find("Interface: " + block.name)->location(),
            fmt::format("surfaces that meet later have no friction: Interface "
                        "`{}` has another one than `{}` (or another "
                        "restitution), and no Contact block decides",
                        block.name, first->name),
            "add `subsection Contact: all` with `set friction = ...`");
        return;
      }
      scene.contacts.push_back(std::move(contact));
    }

    PinInput read_pin(SectionReader &reader, const SceneInput &scene)
    {
      PinInput pin;
      pin.name = reader.block_name();
      if (const auto value =
              reader.raw("material", "", "of the rigid body", "steel")) {
        pin.material = collapse_blanks(value->text());
        check_material(reader, "material", pin.material, scene);
      }
      for (const MaterialInput &material : scene.materials)
        if (material.name == pin.material && !material.rigid)
          reader.error("material",
                       fmt::format("a pin holds a place of a rigid body, and "
                                   "material `{}` is {}",
                                   material.name, material.model_name),
                       "name a material with model = rigid; a Boundary block "
                       "with velocities 0 holds faces");
      const std::vector<double> at =
          reader.numbers("at", "", units::length, Range::any(), scene.dimension,
                         "m, where it stays; in the body at t = 0, or outside");
      std::copy(at.begin(), at.end(), pin.at.begin());
      return pin;
    }
  } // namespace

  void read_contacts(ParameterFile &file, InputErrors &errors,
                     SceneInput &scene)
  {
    std::map<Pair, std::string> owners;
    bool says_something = false;
    for (ParameterSection *block :
         open_large(file, "Contact",
                    "say in Interface and Obstacle blocks what touches", errors,
                    scene)) {
      SectionReader reader(*block, errors);
      const unsigned int n_before = errors.n_errors();
      const ContactInput contact = read_contact(reader, scene);
      says_something = true;
      if (contact.materials[0] == nothing)
        continue;
      scene.contacts.push_back(contact);
      if (errors.n_errors() == n_before)
        claim_pairs(reader, scene.contacts.back(), scene, owners);
    }
    if (scene.large_motion && !says_something && is_of_blocks(scene))
      touch_by_default(file, errors, scene);
  }

  void read_pins(ParameterFile &file, InputErrors &errors, SceneInput &scene)
  {
    for (ParameterSection *block :
         open_large(file, "Pin", "remove the section", errors, scene)) {
      SectionReader reader(*block, errors);
      scene.pins.push_back(read_pin(reader, scene));
    }
  }
} // namespace nsfd
