#pragma once
// Random discrete scenes, degenerate ones included, each made from a recipe that can be shrunk.
#include <cstdlib>
#include <fstream>
#include <functional>
#include <ostream>

#include "scene.h"

namespace frictioncg::test {

/// A number that the environment may choose.
inline unsigned from_environment(const char* name, unsigned otherwise) {
  const char* value = std::getenv(name);
  return value ? static_cast<unsigned>(std::strtoul(value, nullptr, 10)) : otherwise;
}

/// What a random scene is made from. The same recipe makes the same scene.
struct Recipe {
  unsigned seed = 1;
  bool algebraic =
      false;  ///< a random matrix on the contact nodes alone, in place of an elastic block
  BlockOptions block;
  int nodes = 1;            ///< algebraic: contact nodes
  int rank_deficit = 0;     ///< algebraic: A is only semi-definite
  Real contrast = 1;        ///< algebraic: stiffness from node to node
  bool gaps = false;        ///< random initial gaps, open and closed
  bool equal_gaps = false;  ///< of two values only: nodes that arrive together
  bool mu_varies = false;
  bool mu_vanishes = false;  ///< at some of the nodes
  bool no_load = false;
  bool orthotropic = false;
  Real cohesion = 0;  ///< over the force of a node under the pressure; coulomb
  Real cap = 0;       ///< likewise; 0: none
  bool bounds_vary = false;

  /// A is definite on what contact leaves free to move, so that a solution exists for every law.
  bool has_solution() const {
    return algebraic ? rank_deficit == 0
                     : block.clamp_side && block.d == 2 && (block.pressure > 0 || no_load);
  }

  friend std::ostream& operator<<(std::ostream& out, const Recipe& r) {
    const BlockOptions& b = r.block;
    out << "seed " << r.seed << (r.algebraic ? ", algebraic" : ", block") << ", " << b.d << "D, ";
    if (r.algebraic)
      out << r.nodes << " nodes, rank deficit " << r.rank_deficit << ", contrast " << r.contrast;
    else
      out << b.cells << " cells, nu " << b.nu << ", distortion " << b.distortion << ", clamped "
          << b.clamp_side;
    return out << ", law " << int(b.law) << ", mu " << b.mu << ", pressure " << b.pressure
               << ", shear " << b.shear << ", angle " << b.angle << ", gaps " << r.gaps
               << r.equal_gaps << ", mu varies " << r.mu_varies << ", vanishes " << r.mu_vanishes
               << ", no load " << r.no_load << ", orthotropic " << r.orthotropic << ", cohesion "
               << r.cohesion << ", cap " << r.cap << ", bounds vary " << r.bounds_vary;
  }
};

Recipe random_recipe(unsigned seed);

/// The same scene with cohesion, a cap, or both, where it has Coulomb's law.
Recipe with_bounds(Recipe r);

/// A random symmetric semi-definite matrix on contact nodes alone, with random normals.
Scene algebraic_scene(const Recipe& r, std::mt19937& random);

Scene make_scene(const Recipe& r);

/// The simplest recipe found that still fails.
Recipe shrink(Recipe r, const std::function<bool(const Recipe&)>& fails);

/// The scene as a file of numbers: n d nodes law; triplets; b; per node its dofs, normal, gap, mu
/// or g, direction, across.
void write(const Scene& s, const std::string& file);

}  // namespace frictioncg::test
